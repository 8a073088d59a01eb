#include "renderer/scene/load.h"

#include <algorithm>
#include <chrono>

#include "renderer/base/error.h"
#include "renderer/base/files.h"
#include "renderer/base/sha256.h"
#include "renderer/scene/scene.h"
#include "renderer/scene/seesharp.h"

namespace misbench {

namespace fs = std::filesystem;

std::string scene_content_hash(const fs::path& file) {
    // Name and size before the bytes: no two different scenes give the same stream.
    Sha256 hash;
    const auto add = [&hash](const std::string& name, const std::string& bytes) {
        hash.update(name + '\0' + std::to_string(bytes.size()) + '\0');
        hash.update(bytes);
    };
    add("scene", read_file(file));
    for (const std::string& name : seesharp_references(file)) {
        add(name, read_file(file.parent_path() / name));
    }
    return hash.hex();
}

LoadedScene load_scene(const fs::path& file, int build_threads) {
    using Clock = std::chrono::steady_clock;
    const auto seconds = [](Clock::duration d) { return std::chrono::duration<double>(d).count(); };
    const auto start = Clock::now();
    SceneDescription description = import_seesharp(file);
    const auto loaded = Clock::now();
    LoadedScene result;
    result.scene = std::make_shared<const Scene>(std::move(description), build_threads);
    result.load_seconds = seconds(loaded - start);
    result.build_seconds = seconds(Clock::now() - loaded);
    return result;
}

std::vector<SceneListing> list_scenes(const fs::path& folder) {
    if (!fs::is_directory(folder)) {
        throw Error(Errc::NotFound, "list scenes: no folder '" + folder.string() + "'");
    }
    std::vector<SceneListing> scenes;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (entry.path().extension() != ".json") continue;
        fs::path name = fs::relative(entry.path(), folder).replace_extension();
        if (name.has_parent_path() && name.stem() == name.parent_path().filename()) {
            name = name.parent_path();
        }
        scenes.push_back({name.generic_string(), entry.path()});
    }
    std::sort(scenes.begin(), scenes.end(),
              [](const SceneListing& a, const SceneListing& b) { return a.name < b.name; });
    return scenes;
}

}  // namespace misbench
