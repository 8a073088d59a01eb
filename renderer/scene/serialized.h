// Meshes in Mitsuba's own binary format, versions 3 and 4: compressed, several to a file.
#pragma once

#include <filesystem>

#include "renderer/scene/description.h"

namespace misbench {

// Reads mesh number `index` of the file, from 0. Normals come as the file has them; vertex colours
// are passed over. Throws InvalidArgument with file, place and reason.
Mesh read_serialized(const std::filesystem::path& path, std::size_t index);

}  // namespace misbench
