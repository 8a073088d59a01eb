// Scenes made in memory that hold something of everything: all materials, all kinds of lights.
#pragma once

#include <memory>

#include "tests/support/materials.h"
#include "tests/support/scenes.h"

namespace misbench::test {

// The normals of a quad's corners, as if it were a part of something round.
inline Mesh bent(Mesh mesh, float by) {
    const Vec3 middle =
        0.25F * (mesh.positions[0] + mesh.positions[1] + mesh.positions[2] + mesh.positions[3]);
    const Vec3 normal = normalized(
        cross(mesh.positions[1] - mesh.positions[0], mesh.positions[2] - mesh.positions[0]));
    for (const Vec3 corner : mesh.positions) {
        mesh.normals.push_back(normalized(normal + by * (corner - middle)));
    }
    return mesh;
}

// What surfaces of several layers are made of.
inline std::vector<SurfaceMaterial> layered_materials() {
    const Material matte = DiffuseMaterial{{0.7F, 0.5F, 0.3F}};
    const Material glass = DielectricMaterial({});
    std::vector<SurfaceMaterial> all;
    SurfaceMaterial mask = surface(matte);
    mask.opacity.value = 0.6F;
    mask.name = "mask";
    all.push_back(mask);
    SurfaceMaterial masked_glass = surface(glass);
    masked_glass.opacity.value = 0.7F;
    masked_glass.name = "masked glass";
    all.push_back(masked_glass);
    SurfaceMaterial blend = surface(matte);
    blend.front.other = Layer{.material = ConductorMaterial({})};
    blend.front.other_weight.value = 0.4F;
    blend.name = "half mirror";
    all.push_back(blend);
    SurfaceMaterial two_sided = surface(PlasticMaterial({}));
    two_sided.back = SurfaceMaterial::Back::Other;
    two_sided.other_back = Side{.layer = {.material = matte}};
    all.push_back(two_sided);
    SurfaceMaterial one_sided = surface(RoughConductorMaterial({.alpha = 0.2F}));
    one_sided.back = SurfaceMaterial::Back::Black;
    all.push_back(one_sided);
    return all;
}

// A room of 4 × 2 × 4, open to the front and above, with balls of all materials in rows.
inline SceneDescription gallery() {
    SceneDescription scene;
    scene.materials = {surface(DiffuseMaterial{{0.7F, 0.7F, 0.7F}}),
                       surface(RoughPlasticMaterial({.alpha = 0.3F}))};
    scene.meshes.push_back(quad({-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, 0));
    scene.meshes.push_back(bent(quad({-2, 0, -2}, {2, 0, -2}, {2, 2, -2}, {-2, 2, -2}, 1), 0.2F));
    scene.meshes.push_back(bent(quad({-2, 0, 2}, {-2, 0, -2}, {-2, 2, -2}, {-2, 2, 2}, 0), 0.2F));
    // Refraction into nearly the same medium, by very small angles, loses in the half vector as
    // many digits as there are: the densities of the narrowest lobes are right to 2 % only.
    const auto is_lost = [](const MaterialRow& row) {
        return row.eta > 1 && row.eta < 1.1F && row.lobe.x > 0 && row.lobe.x < 0.01F;
    };
    std::vector<SurfaceMaterial> materials = layered_materials();
    for (const MaterialRow& row : detailed_rows()) {
        if (is_lost(row)) continue;
        materials.push_back(surface(row.material));
        materials.back().name = row.name;
    }
    for (std::size_t i = 0; i < materials.size(); ++i) {
        const auto column = static_cast<float>(i % 8);
        const auto row = static_cast<float>(i / 8);
        const Vec3 centre = {-1.75F + 0.5F * column, 0.21F, 1.2F - 0.5F * row};
        scene.quadrics.push_back(ball(centre, 0.2F, scene.materials.size()));
        scene.materials.push_back(materials[i]);
    }
    // At (0, 2, 4), looking along (0, -1, -2).
    const Vec3 back = normalized({0, 1, 2});
    const Vec3 up = cross(back, {1, 0, 0});
    scene.camera.to_world.rows = {
        {{1, up.x, back.x, 0}, {0, up.y, back.y, 2}, {0, up.z, back.z, 4}}};
    scene.camera.fov_degrees = 50;
    return scene;
}

inline SceneDescription lit_by_surfaces(SceneDescription scene) {
    scene.meshes.push_back(quad({-0.5F, 1.9F, -0.5F}, {0.5F, 1.9F, -0.5F}, {0.5F, 1.9F, 0.5F},
                                {-0.5F, 1.9F, 0.5F}, 0, {9, 8, 7}));
    scene.quadrics.push_back(ball({1.5F, 1.2F, -1}, 0.15F, 0, {20, 20, 30}));
    return scene;
}
inline SceneDescription lit_by_points(SceneDescription scene) {
    scene.point_lights.push_back({.position = {-1, 1.5F, 0.5F}, .intensity = {3, 3, 2}});
    scene.spot_lights.push_back({.position = {1.5F, 1.8F, 1.5F},
                                 .direction = normalized({-1, -1.2F, -1}),
                                 .intensity = {8, 9, 9},
                                 .cutoff_angle = 0.6F,
                                 .beam_width = 0.4F});
    return scene;
}
inline SceneDescription lit_from_far(SceneDescription scene) {
    scene.directional_lights.push_back(
        {.direction = normalized({0.3F, -1, -0.4F}), .irradiance = {2, 2, 2}});
    const auto sky = std::make_shared<Image>(8, 4);
    for (std::size_t i = 0; i < sky->rgb.size(); ++i) {
        sky->rgb[i] = 0.2F + static_cast<float>(i * 7 % 11) / 11;
    }
    scene.environment = EnvironmentDescription{.radiance = sky};
    return scene;
}
inline SceneDescription through_a_lens(SceneDescription scene) {
    scene.camera.lens_radius = 0.1F;
    scene.camera.focus_distance = 4;
    return scene;
}

}  // namespace misbench::test
