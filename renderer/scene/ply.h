// PLY meshes: ascii and binary of both byte orders. Polygons become fans of triangles.
#pragma once

#include <filesystem>

#include "renderer/scene/description.h"

namespace misbench {

// Reads vertex properties x y z, nx ny nz and u v or s t, and the face list vertex_index or
// vertex_indices; other elements and properties are passed over. Normals come as the file has
// them. Throws InvalidArgument with file, place and reason.
Mesh read_ply(const std::filesystem::path& path);

}  // namespace misbench
