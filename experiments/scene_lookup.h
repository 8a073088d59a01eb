// From what a user calls a scene to its file.
#pragma once

#include <filesystem>
#include <string>

#include "renderer/scene/load.h"

namespace misbench {

// The folder in which scenes are looked up by name: `option` when not empty, else the environment's
// MISBENCH_SCENES, else the one in the source tree this program was built from. Throws NotFound
// when it is no folder.
std::filesystem::path scene_folder(const std::string& option);

// A scene by path, relative to `base`, or by its name below `folder`. Throws InvalidArgument with
// the names that are known.
SceneListing find_scene(const std::string& name_or_path, const std::filesystem::path& base,
                        const std::filesystem::path& folder);

}  // namespace misbench
