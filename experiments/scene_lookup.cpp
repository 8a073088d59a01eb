#include "experiments/scene_lookup.h"

#include <algorithm>
#include <cstdlib>

#include "experiments/plan/suggestion.h"
#include "renderer/base/error.h"

namespace misbench {
namespace fs = std::filesystem;

fs::path scene_folder(const std::string& option) {
    fs::path folder = MISBENCH_SOURCE_SCENES;
    if (const char* environment = std::getenv("MISBENCH_SCENES")) folder = environment;
    if (!option.empty()) folder = option;
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored)) {
        throw Error(Errc::NotFound, "open scene folder '" + folder.string() +
                                        "': not a folder; known: --scenes FOLDER, MISBENCH_SCENES");
    }
    return folder;
}

SceneListing find_scene(const std::string& name_or_path, const fs::path& base,
                        const fs::path& folder) {
    std::error_code ignored;
    const fs::path path = base / name_or_path;
    if (fs::is_regular_file(path, ignored)) {
        return {.name = path.stem().string(), .file = fs::weakly_canonical(path)};
    }
    std::vector<std::string> known;
    for (const SceneListing& scene : list_scenes(folder)) {
        if (scene.name == name_or_path) {
            return {.name = scene.name, .file = fs::weakly_canonical(scene.file)};
        }
        known.push_back(scene.name);
    }
    throw Error(Errc::InvalidArgument, unknown_name("scene", name_or_path, known));
}

}  // namespace misbench
