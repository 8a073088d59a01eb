#include "renderer/scene/load.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <map>
#include <set>
#include <string_view>

#include "renderer/base/error.h"
#include "renderer/base/files.h"
#include "renderer/base/parameters.h"
#include "renderer/base/sha256.h"
#include "renderer/scene/mitsuba/import.h"
#include "renderer/scene/scene.h"
#include "renderer/scene/seesharp.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;

// A scene format, by the extension of its files.
struct SceneFormat {
    std::string_view extension;
    SceneDescription (*import)(const fs::path& file);
    std::vector<std::string> (*references)(const fs::path& file);
    // What every scene of the format has in its text, even a broken one: other files of the same
    // extension are not listed.
    std::array<std::string_view, 2> marks;
    // What a scene has in its text that includes another file of the format; "" if none can.
    std::string_view include_mark;
};

// To add a format: write its importer, add its row.
constexpr std::array kFormats{
    SceneFormat{".json", import_seesharp, seesharp_references, {"\"cameras\"", "\"objects\""}, ""},
    SceneFormat{".xml", import_mitsuba, mitsuba_references, {"<scene", "version"}, "<include"},
};

const SceneFormat* find_format(const fs::path& file) {
    const std::string extension = file.extension();
    const auto* row =
        std::find_if(kFormats.begin(), kFormats.end(),
                     [&](const SceneFormat& format) { return format.extension == extension; });
    return row == kFormats.end() ? nullptr : row;
}

const SceneFormat& format_of(const fs::path& file) {
    if (const SceneFormat* format = find_format(file)) return *format;
    std::string known;
    for (const SceneFormat& format : kFormats) known += " " + std::string(format.extension);
    throw Error(Errc::InvalidArgument, "scene '" + file.string() + "': unknown format '" +
                                           file.extension().string() + "'; known:" + known);
}

bool contains(std::string_view text, std::string_view part) {
    return text.find(part) != std::string_view::npos;
}

// The files that a scene's text includes; none where it is broken, which loading it will tell.
std::vector<fs::path> included_by(const SceneFormat& format, const fs::path& file) {
    std::vector<fs::path> files;
    try {
        for (const std::string& name : format.references(file)) {
            if (find_format(name) == &format) files.push_back(file.parent_path() / name);
        }
    } catch (const Error&) {
    }
    return files;
}

// The scene files below a folder. A file that another one includes is a part of it.
std::vector<fs::path> scene_files(const fs::path& folder) {
    std::vector<fs::path> scenes;
    std::set<fs::path> parts;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        const SceneFormat* format = find_format(entry.path());
        if (format == nullptr || !entry.is_regular_file()) continue;
        const std::string text = read_file(entry.path());
        if (!std::all_of(format->marks.begin(), format->marks.end(),
                         [&text](std::string_view mark) { return contains(text, mark); })) {
            continue;
        }
        scenes.push_back(entry.path());
        if (format->include_mark.empty() || !contains(text, format->include_mark)) continue;
        for (const fs::path& part : included_by(*format, entry.path())) {
            parts.insert(part.lexically_normal());
        }
    }
    std::erase_if(
        scenes, [&parts](const fs::path& file) { return parts.contains(file.lexically_normal()); });
    return scenes;
}

// "VeachMIS" for VeachMIS/VeachMIS.json and VeachMIS/scene.xml, "Box/LightTop" for
// Box/LightTop.json.
std::string scene_name(const fs::path& relative) {
    const fs::path name = fs::path(relative).replace_extension();
    const bool speaks_for_folder =
        name.has_parent_path() &&
        (name.filename() == name.parent_path().filename() || name.filename() == "scene");
    return (speaks_for_folder ? name.parent_path() : name).generic_string();
}

// Farther out Embree ends the process: products of coordinates must be finite in single precision.
constexpr float kFarthest = 0x1p56F;

void require_reach(const SceneDescription& description, const fs::path& file) {
    for (const Mesh& mesh : description.meshes) {
        for (const Vec3 p : mesh.positions) {
            const float reach = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
            if (reach <= kFarthest) continue;
            throw Error(Errc::InvalidArgument, "scene '" + file.string() + "': mesh '" + mesh.name +
                                                   "' reaches " +
                                                   to_string(ParameterValue(double{reach})) +
                                                   " from the origin; known: up to " +
                                                   to_string(ParameterValue(double{kFarthest})));
        }
    }
}

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

std::string scene_content_hash(const fs::path& file) {
    const SceneFormat& format = format_of(file);
    // Name and size before the bytes: no two different scenes give the same stream.
    Sha256 hash;
    const auto add = [&hash](const std::string& name, const std::string& bytes) {
        hash.update(name + '\0' + std::to_string(bytes.size()) + '\0');
        hash.update(bytes);
    };
    add("scene", read_file(file));
    for (const std::string& name : format.references(file)) {
        add(name, read_file(file.parent_path() / name));
    }
    return hash.hex();
}

SceneDescription import_scene(const fs::path& file) {
    SceneDescription description = format_of(file).import(file);
    require_reach(description, file);
    return description;
}

LoadedScene build_scene(SceneDescription description, int build_threads,
                        const SceneFeatures& assumed) {
    LoadedScene result;
    result.notes = std::move(description.notes);
    result.n_instances = description.n_instances;
    for (const Mesh& mesh : description.meshes) {
        result.n_degenerate_triangles += mesh.triangles.size();
    }
    const auto start = Clock::now();
    result.scene = std::make_shared<const Scene>(std::move(description), build_threads, assumed);
    result.build_seconds = seconds_since(start);
    result.n_degenerate_triangles -= result.scene->triangles().size();
    return result;
}

LoadedScene load_scene(const fs::path& file, int build_threads, const SceneFeatures& assumed) {
    const auto start = Clock::now();
    SceneDescription description = import_scene(file);
    const double load_seconds = seconds_since(start);
    LoadedScene result = build_scene(std::move(description), build_threads, assumed);
    result.load_seconds = load_seconds;
    return result;
}

std::vector<SceneListing> list_scenes(const fs::path& folder) {
    if (!fs::is_directory(folder)) {
        throw Error(Errc::NotFound, "list scenes: no folder '" + folder.string() + "'");
    }
    std::map<std::string, int> n_of_name;
    std::vector<SceneListing> scenes;
    for (const fs::path& file : scene_files(folder)) {
        scenes.push_back({scene_name(fs::relative(file, folder)), file});
        ++n_of_name[scenes.back().name];
    }
    // Files that would share a name keep the whole of theirs.
    for (SceneListing& scene : scenes) {
        if (n_of_name[scene.name] > 1) {
            scene.name = fs::relative(scene.file, folder).generic_string();
        }
    }
    std::sort(scenes.begin(), scenes.end(),
              [](const SceneListing& a, const SceneListing& b) { return a.name < b.name; });
    return scenes;
}

}  // namespace misbench
