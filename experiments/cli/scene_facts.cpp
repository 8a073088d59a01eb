#include "experiments/cli/scene_facts.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "experiments/cli/output.h"
#include "renderer/methods/catalogue.h"
#include "renderer/methods/specialize.h"

namespace misbench {
namespace {

using Json = nlohmann::ordered_json;

std::string_view name(PerspectiveCamera::FovAxis axis) {
    switch (axis) {
        case PerspectiveCamera::FovAxis::Vertical:
            return "vertical";
        case PerspectiveCamera::FovAxis::Horizontal:
            return "horizontal";
        case PerspectiveCamera::FovAxis::Diagonal:
            return "diagonal";
        case PerspectiveCamera::FovAxis::Smaller:
            return "smaller";
        case PerspectiveCamera::FovAxis::Larger:
            return "larger";
    }
    return "";
}

bool is_whole(const PerspectiveCamera::Window& w) {
    return w.x0 == 0 && w.y0 == 0 && w.x1 == 1 && w.y1 == 1;
}

Vec3 view_direction(const PerspectiveCamera& camera) {
    return normalized(camera.to_world.direction({0, 0, -1}));
}

Json to_json(Vec3 v) { return Json::array({v.x, v.y, v.z}); }
Json to_json(Rgb c) { return Json::array({c.r, c.g, c.b}); }
std::string to_text(Vec3 v) { return fmt::format("({:.4g}, {:.4g}, {:.4g})", v.x, v.y, v.z); }
std::string to_text(Rgb c) { return fmt::format("({:.4g}, {:.4g}, {:.4g})", c.r, c.g, c.b); }

std::string bytes_to_text(std::size_t n) {
    const auto bytes = static_cast<double>(n);
    if (bytes < 1e3) return fmt::format("{} B", n);
    if (bytes < 1e6) return fmt::format("{:.3g} kB", bytes / 1e3);
    if (bytes < 1e9) return fmt::format("{:.3g} MB", bytes / 1e6);
    return fmt::format("{:.3g} GB", bytes / 1e9);
}

// "a, b, c".
template <class List, class Format>
std::string joined(const List& list, const Format& format) {
    std::string text;
    for (const auto& item : list) text += (text.empty() ? "" : ", ") + format(item);
    return text;
}

// "3 with opacity" where it is not 0, after a separator.
std::string if_any(std::size_t n, const char* what) {
    return n == 0 ? "" : fmt::format("; {} {}", n, what);
}

Json materials_to_json(const SceneFacts& facts) {
    Json types = Json::object();
    for (const auto& [type, use] : facts.materials) {
        types[type] = {{"front", use.n_front}, {"back", use.n_back}, {"blended", use.n_blended}};
    }
    return {{"n", facts.n_materials},
            {"types", types},
            {"black_backs", facts.n_black_backs},
            {"other_backs", facts.n_other_backs},
            {"blends", facts.n_blends},
            {"with_opacity", facts.n_with_opacity}};
}

Json lights_to_json(const SceneFacts& facts) {
    Json types = Json::object();
    for (const auto& [type, use] : facts.lights) {
        types[type] = {{"n", use.n}, {"power", to_json(use.power)}};
    }
    return {{"n", facts.n_lights()}, {"types", types}, {"power", to_json(facts.power())}};
}

Json textures_to_json(const SceneFacts& facts) {
    Json textures = Json::array();
    for (const TextureFacts& texture : facts.textures) {
        Json entry = {{"kind", texture.kind}};
        if (texture.width > 0) {
            entry["width"] = texture.width;
            entry["height"] = texture.height;
            entry["bytes"] = texture.n_bytes;
        }
        textures.push_back(std::move(entry));
    }
    return textures;
}

Json camera_to_json(const Scene& scene) {
    const PerspectiveCamera& camera = scene.camera();
    const PerspectiveCamera::Window& w = camera.window;
    Json json = {{"position", to_json(camera.to_world.translation())},
                 {"direction", to_json(view_direction(camera))},
                 {"fov_degrees", camera.fov_degrees},
                 {"fov_axis", name(camera.fov_axis)},
                 {"lens_radius", camera.lens_radius},
                 {"focus_distance", camera.focus_distance},
                 {"window", Json::array({w.x0, w.y0, w.x1, w.y1})}};
    if (scene.film().width > 0) {
        json["image"] = Json::array({scene.film().width, scene.film().height});
    }
    return json;
}

std::string textures_to_text(const SceneFacts& facts) {
    if (facts.textures.empty()) return "none";
    return fmt::format("{}: {}; {}", facts.textures.size(),
                       joined(facts.textures,
                              [](const TextureFacts& t) {
                                  return t.width == 0 ? t.kind
                                                      : fmt::format("{}x{}", t.width, t.height);
                              }),
                       bytes_to_text(facts.n_texture_bytes));
}

std::string camera_to_text(const PerspectiveCamera& camera) {
    const std::string lens = camera.lens_radius == 0
                                 ? "pinhole"
                                 : fmt::format("lens of radius {:.4g} focused at {:.4g}",
                                               camera.lens_radius, camera.focus_distance);
    const PerspectiveCamera::Window& w = camera.window;
    const std::string window =
        is_whole(w) ? ""
                    : fmt::format("; the part [{:g}, {:g}] x [{:g}, {:g}] of the film", w.x0, w.x1,
                                  w.y0, w.y1);
    return fmt::format("at {}, looks along {}, {:.4g}° ({}), {}{}",
                       to_text(camera.to_world.translation()), to_text(view_direction(camera)),
                       camera.fov_degrees, name(camera.fov_axis), lens, window);
}

}  // namespace

std::string material_types(const SceneFacts& facts) {
    return joined(facts.materials, [](const auto& entry) {
        const MaterialUse& use = entry.second;
        return fmt::format("{} {}", entry.first, use.n_front + use.n_back + use.n_blended);
    });
}

std::string light_types(const SceneFacts& facts) {
    return joined(facts.lights, [](const auto& entry) {
        return fmt::format("{} {}", entry.first, entry.second.n);
    });
}

std::string feature_list(const Scene& scene) {
    const std::vector<std::string> list = names(scene.features());
    return list.empty() ? "none" : joined(list, [](const std::string& name) { return name; });
}

nlohmann::ordered_json facts_to_json(const SceneListing& listing, const LoadedScene& loaded,
                                     const SceneFacts& facts) {
    const Scene& scene = *loaded.scene;
    Json limits = Json::object();
    for (const MethodInfo& method : methods()) {
        limits[std::string(method.name)] = method.limits(scene.features());
    }
    return {{"name", listing.name},
            {"file", listing.file.string()},
            {"triangles", facts.n_triangles},
            {"degenerate_triangles", facts.n_degenerate_triangles},
            {"quadrics", facts.quadrics},
            {"instances", facts.n_instances},
            {"materials", materials_to_json(facts)},
            {"lobes", facts.lobes},
            {"lights", lights_to_json(facts)},
            {"textures", textures_to_json(facts)},
            {"bytes",
             {{"geometry", facts.n_geometry_bytes},
              {"textures", facts.n_texture_bytes},
              {"environment", facts.n_environment_bytes}}},
            {"box", Json::array({to_json(scene.lower()), to_json(scene.upper())})},
            {"camera", camera_to_json(scene)},
            {"features", names(scene.features())},
            {"plain_loop", is_plain(scene.features())},
            {"limits", limits},
            {"load_seconds", loaded.load_seconds},
            {"build_seconds", loaded.build_seconds},
            {"notes", loaded.notes}};
}

std::string facts_to_text(const SceneListing& listing, const LoadedScene& loaded,
                          const SceneFacts& facts) {
    const Scene& scene = *loaded.scene;
    std::vector<std::vector<std::string>> rows;
    rows.push_back({"scene", listing.name});
    rows.push_back({"file", listing.file.string()});
    rows.push_back(
        {"triangles", fmt::format("{}{}{}", facts.n_triangles,
                                  if_any(facts.n_degenerate_triangles, "without area left out"),
                                  if_any(facts.n_instances, "instances"))});
    rows.push_back(
        {"quadrics", facts.quadrics.empty() ? "none" : joined(facts.quadrics, [](const auto& e) {
             return fmt::format("{} {}", e.first, e.second);
         })});
    rows.push_back({"box", to_text(scene.lower()) + " to " + to_text(scene.upper())});
    rows.push_back(
        {"materials", fmt::format("{}: {}{}{}{}{}", facts.n_materials, material_types(facts),
                                  if_any(facts.n_black_backs, "with a black back"),
                                  if_any(facts.n_other_backs, "with a back of its own"),
                                  if_any(facts.n_blends, "blends"),
                                  if_any(facts.n_with_opacity, "with opacity"))});
    rows.push_back({"lobes", joined(facts.lobes, [](const std::string& lobe) { return lobe; })});
    rows.push_back({"lights", facts.lights.empty()
                                  ? "none"
                                  : fmt::format("{}: {}; {} W", facts.n_lights(),
                                                light_types(facts), to_text(facts.power()))});
    rows.push_back({"textures", textures_to_text(facts)});
    rows.push_back({"memory", fmt::format("geometry {} without the BVH, environment {}",
                                          bytes_to_text(facts.n_geometry_bytes),
                                          bytes_to_text(facts.n_environment_bytes))});
    rows.push_back({"camera", camera_to_text(scene.camera())});
    rows.push_back({"image", scene.film().width > 0
                                 ? fmt::format("{}x{}", scene.film().width, scene.film().height)
                                 : "the file asks for no size"});
    rows.push_back({"features", feature_list(scene)});
    rows.push_back({"render loop", is_plain(scene.features()) ? "plain" : "general"});
    rows.push_back({"seconds", fmt::format("load {:.3g}, build {:.3g}", loaded.load_seconds,
                                           loaded.build_seconds)});
    for (const MethodInfo& method : methods()) {
        const std::string limits = method.limits(scene.features());
        rows.push_back({"method " + std::string(method.name),
                        limits.empty() ? "estimates all light" : limits});
    }
    for (const std::string& note : loaded.notes) rows.push_back({"note", note});
    return align(rows);
}

}  // namespace misbench
