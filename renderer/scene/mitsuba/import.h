// Scenes in Mitsuba's XML format, versions 0.6 and 3, as far as the renderer's shapes, materials,
// lights, textures and cameras go. What cannot be modelled is refused by name.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "renderer/scene/description.h"

namespace misbench {

// Throws NotFound or InvalidArgument: file, place, reason.
SceneDescription import_mitsuba(const std::filesystem::path& file);

// The files that the scene refers to, includes too, in order of appearance, as written; relative
// to the folder of `file`.
std::vector<std::string> mitsuba_references(const std::filesystem::path& file);

}  // namespace misbench
