#include "renderer/scene/inspect.h"

#include <array>
#include <set>

#include "renderer/scene/light_transport.h"

namespace misbench {
namespace {

std::string type_of(const Material& material) {
    return std::string(std::visit([](const auto& m) { return m.kType; }, material));
}

std::vector<std::string> names_of(Lobes lobes) {
    std::vector<std::string> names;
    if (lobes & kDiffuseLobe) names.emplace_back("diffuse");
    if (lobes & kGlossyLobe) names.emplace_back("glossy");
    if (lobes & kDeltaLobe) names.emplace_back("delta");
    if (lobes & kTransmissiveLobe) names.emplace_back("transmissive");
    return names;
}

// By index, whether a surface has the material.
std::vector<bool> used_materials(const Scene& scene) {
    std::vector<bool> is_used(scene.materials().size(), false);
    const auto use = [&](const SurfacePoint& point) {
        is_used[static_cast<std::size_t>(point.material - scene.materials().data())] = true;
    };
    for (std::uint32_t i = 0; i < scene.triangles().size(); ++i) use(scene.point_on(i, {}));
    for (std::uint32_t i = 0; i < scene.quadrics().size(); ++i) {
        use(scene.point_on_quadric(i, scene.quadrics()[i].sample({})));
    }
    return is_used;
}

void add_material(const SurfaceMaterial& material, SceneFacts& facts) {
    const auto add_side = [&](const Side& side, std::size_t MaterialUse::*place) {
        ++(facts.materials[type_of(side.layer.material)].*place);
        if (!side.other) return;
        ++facts.materials[type_of(side.other->material)].n_blended;
        ++facts.n_blends;
    };
    ++facts.n_materials;
    add_side(material.front, &MaterialUse::n_front);
    if (material.back == SurfaceMaterial::Back::Black) ++facts.n_black_backs;
    if (material.back == SurfaceMaterial::Back::Other) {
        ++facts.n_other_backs;
        if (material.other_back) add_side(*material.other_back, &MaterialUse::n_back);
    }
    if (material.opacity.texture != kNoTexture || material.opacity.value != 1) {
        ++facts.n_with_opacity;
    }
}

void add_materials(const Scene& scene, SceneFacts& facts) {
    const std::vector<bool> is_used = used_materials(scene);
    Lobes all = 0;
    for (std::size_t i = 0; i < is_used.size(); ++i) {
        if (!is_used[i]) continue;
        add_material(scene.materials()[i], facts);
        all |= lobes(scene.materials()[i]);
    }
    facts.lobes = names_of(all);
}

std::string_view type_of(const Scene& scene, const Light& light) {
    switch (light.shape) {
        case Light::Shape::Triangle:
            return "triangle";
        case Light::Shape::Quadric:
            return name(scene.quadrics()[light.index].shape());
        case Light::Shape::Point:
            return "point";
        case Light::Shape::Spot:
            return "spot";
        case Light::Shape::Directional:
            return "directional";
        case Light::Shape::Environment:
            return "environment";
    }
    return "";
}

void add_textures(const Scene& scene, SceneFacts& facts) {
    std::set<const TextureImage*> known;
    for (const Texture& texture : scene.textures()) {
        const auto* bitmap = std::get_if<BitmapTexture>(&texture);
        if (bitmap == nullptr) {
            facts.textures.push_back({.kind = "checkerboard"});
            continue;
        }
        const TextureImage& image = *bitmap->image;
        const bool is_new = known.insert(&image).second;
        facts.textures.push_back({.kind = "bitmap",
                                  .width = image.width(),
                                  .height = image.height(),
                                  .n_bytes = is_new ? image.n_bytes() : 0});
        facts.n_texture_bytes += facts.textures.back().n_bytes;
    }
}

}  // namespace

std::size_t SceneFacts::n_lights() const {
    std::size_t n = 0;
    for (const auto& [type, use] : lights) n += use.n;
    return n;
}

Rgb SceneFacts::power() const {
    Rgb sum;
    for (const auto& [type, use] : lights) sum += use.power;
    return sum;
}

SceneFacts inspect(const LoadedScene& loaded) {
    const Scene& scene = *loaded.scene;
    SceneFacts facts;
    facts.n_triangles = scene.triangles().size();
    facts.n_degenerate_triangles = loaded.n_degenerate_triangles;
    facts.n_instances = loaded.n_instances;
    for (const QuadricShape& quadric : scene.quadrics()) {
        ++facts.quadrics[std::string(name(quadric.shape()))];
    }
    add_materials(scene, facts);
    for (std::uint32_t i = 0; i < scene.lights().size(); ++i) {
        LightUse& use = facts.lights[std::string(type_of(scene, scene.lights()[i]))];
        ++use.n;
        use.power += light_power(scene, i);
    }
    add_textures(scene, facts);
    if (scene.environment() != nullptr) {
        facts.n_environment_bytes = scene.environment()->n_bytes();
    }
    facts.n_geometry_bytes = scene.n_geometry_bytes();
    return facts;
}

std::vector<std::string> names(const SceneFeatures& features) {
    std::vector<std::string> names;
    const auto add = [&](bool has, const char* name) {
        if (has) names.emplace_back(name);
    };
    add(features.textures, "textures");
    add(features.layers, "layers");
    add(features.delta_lobes, "delta_lobes");
    add(features.transmission, "transmission");
    add(features.environment, "environment");
    add(features.delta_lights, "delta_lights");
    add(features.quadrics, "quadrics");
    return names;
}

std::string_view name(SceneWarning::Kind kind) {
    switch (kind) {
        case SceneWarning::Kind::NoLight:
            return "no_light";
        case SceneWarning::Kind::DegenerateTriangles:
            return "degenerate_triangles";
        case SceneWarning::Kind::EmitterWithoutArea:
            return "emitter_without_area";
        case SceneWarning::Kind::DuplicateTriangles:
            return "duplicate_triangles";
        case SceneWarning::Kind::WindingConflict:
            return "winding_conflict";
        case SceneWarning::Kind::SharedEdges:
            return "shared_edges";
        case SceneWarning::Kind::OpposedNormals:
            return "opposed_normals";
        case SceneWarning::Kind::OpposedEmitterNormals:
            return "opposed_emitter_normals";
        case SceneWarning::Kind::MissingUv:
            return "missing_uv";
        case SceneWarning::Kind::FlippedEmitter:
            return "flipped_emitter";
        case SceneWarning::Kind::CameraInside:
            return "camera_inside";
        case SceneWarning::Kind::CameraTooClose:
            return "camera_too_close";
        case SceneWarning::Kind::BlackImage:
            return "black_image";
        case SceneWarning::Kind::BadSamples:
            return "bad_samples";
    }
    return "";
}

}  // namespace misbench
