// From a scene file to a scene that can be rendered.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "renderer/scene/scene.h"

namespace misbench {

// Throws NotFound or InvalidArgument: file, place, reason.
SceneDescription import_scene(const std::filesystem::path& file);

// SHA-256 over the bytes of the scene file and of every file it refers to (meshes, textures,
// included files), in the order its importer gives them, with the names as written: equal wherever
// the scene lies. Throws NotFound or InvalidArgument naming the file that is missing or broken.
std::string scene_content_hash(const std::filesystem::path& file);

struct LoadedScene {
    std::shared_ptr<const Scene> scene;
    double load_seconds = 0;   // wall: file to description
    double build_seconds = 0;  // wall: BVH and light tables
    // What the scene does not keep of its description.
    std::vector<std::string> notes{};
    std::size_t n_instances = 0;
    std::size_t n_degenerate_triangles = 0;
};

// All but load_seconds. `assumed` as for Scene.
LoadedScene build_scene(SceneDescription description, int build_threads,
                        const SceneFeatures& assumed = {});

// import_scene(), then build_scene().
LoadedScene load_scene(const std::filesystem::path& file, int build_threads,
                       const SceneFeatures& assumed = {});

// The scene files below `folder`, by name: "VeachMIS" for VeachMIS/VeachMIS.json, "veach-mis" for
// veach-mis/scene.xml, "Box/LightTop" for Box/LightTop.json; scenes that would share a name keep
// all of their path, with the extension. Files that another scene includes, and files whose text is
// not a scene's, are left out.
struct SceneListing {
    std::string name;
    std::filesystem::path file;
};
std::vector<SceneListing> list_scenes(const std::filesystem::path& folder);

}  // namespace misbench
