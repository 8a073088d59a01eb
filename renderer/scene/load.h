// From a scene file to a scene that can be rendered.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace misbench {

class Scene;

// SHA-256 over the bytes of the scene file and of every file it refers to, in their order of
// appearance, with the names as written: equal wherever the scene lies. Throws NotFound or
// InvalidArgument naming the file that is missing or broken.
std::string scene_content_hash(const std::filesystem::path& file);

struct LoadedScene {
    std::shared_ptr<const Scene> scene;
    double load_seconds = 0;   // wall: file to description
    double build_seconds = 0;  // wall: BVH and light tables
};

// Throws NotFound or InvalidArgument: file, place, reason.
LoadedScene load_scene(const std::filesystem::path& file, int build_threads);

// The scene files below `folder`, by name: "VeachMIS" for VeachMIS/VeachMIS.json,
// "Box/LightTop" for Box/LightTop.json.
struct SceneListing {
    std::string name;
    std::filesystem::path file;
};
std::vector<SceneListing> list_scenes(const std::filesystem::path& folder);

}  // namespace misbench
