// OBJ meshes with materials by name; the .mtl file is never read.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "renderer/scene/description.h"

namespace misbench {

// What one `usemtl` covers, with vertices of its own. Polygons become fans of triangles; v is
// turned (1 - v), so that row 0 of a texture is its top. A corner without texture coordinates has
// (0, 0) where others of its part have some. Normals come as the file has them; a part in which
// some corner has none has none at all.
struct ObjPart {
    std::string material;
    Mesh mesh;
};

// Throws InvalidArgument with file, place and reason.
std::vector<ObjPart> read_obj(const std::filesystem::path& path);

}  // namespace misbench
