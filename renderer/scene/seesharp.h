// Scenes in SeeSharp's JSON format. What cannot be modelled is refused by name; what the format's
// own renderer ignores is ignored too, and noted where a reader of the file would not expect it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "renderer/scene/description.h"

namespace misbench {

// Throws NotFound or InvalidArgument: file, place, reason.
SceneDescription import_seesharp(const std::filesystem::path& file);

// The files that the scene refers to, as written: of the background, the materials, the objects.
std::vector<std::string> seesharp_references(const std::filesystem::path& file);

}  // namespace misbench
