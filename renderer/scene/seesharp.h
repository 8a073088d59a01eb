// Scenes in SeeSharp's JSON format, as far as diffuse and reflective generic materials, inline,
// PLY and OBJ meshes and a perspective camera go. What cannot be modelled is refused by name.
#pragma once

#include <filesystem>
#include <vector>

#include "renderer/scene/description.h"

namespace misbench {

// Throws NotFound or InvalidArgument: file, place, reason.
SceneDescription import_seesharp(const std::filesystem::path& file);

// The files that the scene refers to, in order of appearance, as written.
std::vector<std::string> seesharp_references(const std::filesystem::path& file);

}  // namespace misbench
