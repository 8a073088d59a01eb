// On small scenes, each with one kind of light, material or camera, all estimators that find all
// light have the same expected image. What each finds is in tests/support/estimators.cpp.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/expect_agreement.h"
#include "tests/support/scenes.h"
#include "tests/support/statistics.h"

namespace misbench {
namespace {

// One false alarm among all scenes with less than this probability.
constexpr double kAlpha = 0.01;
constexpr int kSeeds = 16;
// A bias of the whole image that must be found.
constexpr double kDetectableBias = 0.1;

struct Row {
    std::string name;
    SceneDescription scene;
    // Where lamps are in sight, the noise of their pixels would cover that of all others.
    test::PathLengths lengths{2, 4};
    std::int64_t samples = 3;  // a seed
};

SceneDescription lit_box() {
    SceneDescription scene = test::open_box();
    scene.meshes.push_back(test::ceiling_lamp());
    return scene;
}

std::size_t add_material(SceneDescription& scene, const SurfaceMaterial& material) {
    scene.materials.push_back(material);
    return scene.materials.size() - 1;
}

// A ball of the material on the left of the floor.
SceneDescription with_ball(SceneDescription scene, const Material& material) {
    const std::size_t index = add_material(scene, test::surface(material));
    scene.quadrics.push_back(test::ball({-0.35F, -0.55F, 0.1F}, 0.4F, index));
    return scene;
}

SceneDescription glossy_walls() {
    SceneDescription scene = lit_box();
    scene.materials[1] = test::surface(GenericMaterial(
        {.base_color = {0.8F, 0.3F, 0.3F}, .roughness = 0.5F, .ior = 1.45F, .metallic = 0.6F}));
    scene.materials[2] = test::surface(
        RoughPlasticMaterial({.diffuse_reflectance = {0.2F, 0.5F, 0.2F}, .alpha = 0.3F}));
    return scene;
}

SceneDescription with_point_light(SceneDescription scene) {
    scene.point_lights = {{.position = {0.3F, 0.6F, 0.2F}, .intensity = {1, 1.2F, 1.5F}}};
    return scene;
}

SceneDescription spot_light() {
    SceneDescription scene = test::open_box();
    scene.spot_lights = {{.position = {0.2F, 0.9F, 0},
                          .direction = normalized({-0.3F, -1, -0.2F}),
                          .intensity = {4, 4, 3},
                          .cutoff_angle = 0.7F,
                          .beam_width = 0.4F}};
    return scene;
}

SceneDescription directional_light() {
    SceneDescription scene = test::open_box();
    scene.directional_lights = {
        {.direction = normalized({0.3F, -0.5F, -1}), .irradiance = {3, 2.5F, 2}}};
    return scene;
}

// A dim sky with two brighter pixels in front of the box and above it.
SceneDescription environment() {
    SceneDescription scene = test::open_box();
    Image sky(8, 4);
    for (float& value : sky.rgb) value = 0.3F;
    for (const std::size_t pixel : {std::size_t{8 + 1}, std::size_t{16 + 2}}) {
        for (std::size_t c = 0; c < 3; ++c) sky.rgb[3 * pixel + c] = 6 - static_cast<float>(c);
    }
    scene.environment =
        EnvironmentDescription{.radiance = std::make_shared<const Image>(std::move(sky))};
    return scene;
}

// A square that stands on the floor, with uv over it.
Mesh screen(std::size_t material) {
    Mesh mesh = test::quad({-0.6F, -0.9F, 0}, {0.5F, -0.9F, 0.3F}, {0.5F, 0.3F, 0.3F},
                           {-0.6F, 0.3F, 0}, material);
    mesh.uvs = {{0, 1}, {2, 1}, {2, 0}, {0, 0}};
    return mesh;
}

SceneDescription opacity_mask() {
    SceneDescription scene = lit_box();
    scene.textures = {CheckerboardTexture{.color0 = kWhite, .color1 = {0.3F, 0.3F, 0.3F}}};
    SurfaceMaterial masked = test::surface(DiffuseMaterial{{0.8F, 0.6F, 0.2F}});
    masked.opacity = {.value = 1, .texture = 0};
    scene.meshes.push_back(screen(add_material(scene, masked)));
    return scene;
}

SceneDescription textured_blend() {
    SceneDescription scene = lit_box();
    scene.textures = {
        CheckerboardTexture{.color0 = {0.9F, 0.9F, 0.9F}, .color1 = {0.2F, 0.2F, 0.2F}},
        CheckerboardTexture{.color0 = {0.8F, 0.2F, 0.1F}, .color1 = {0.1F, 0.3F, 0.8F}}};
    SurfaceMaterial blend = test::surface(DiffuseMaterial{});
    blend.front.layer.color_texture = 1;
    blend.front.other = Layer{.material = RoughConductorMaterial({.alpha = 0.3F})};
    blend.front.other_weight = {.value = 0, .texture = 0};
    scene.meshes.push_back(screen(add_material(scene, blend)));
    return scene;
}

SceneDescription thin_lens() {
    SceneDescription scene = with_ball(lit_box(), RoughDiffuseMaterial({}));
    scene.camera.lens_radius = 0.15F;
    scene.camera.focus_distance = 3;
    return scene;
}

SceneDescription shading_normals() {
    SceneDescription scene = lit_box();
    scene.meshes.push_back(test::smooth_octahedron({0, -0.3F, 0}, 0.6F, 0));
    const std::size_t plastic = add_material(
        scene, test::surface(RoughPlasticMaterial({.diffuse_reflectance = {0.3F, 0.4F, 0.6F}})));
    scene.meshes.push_back(test::smooth_octahedron({0.5F, 0.3F, -0.4F}, 0.4F, plastic));
    return scene;
}

std::vector<Row> scenes() {
    return {
        {"diffuse_box", lit_box()},
        {"lamp_in_sight", lit_box(), {1, 4}},
        {"direct_light", lit_box(), {1, 2}, 6},
        // Connections and merging alone have all weight here.
        {"three_edges", lit_box(), {3, 3}, 6},
        {"four_edges_on_gloss", glossy_walls(), {4, 4}, 6},
        {"glossy_walls", glossy_walls()},
        {"rough_glass", with_ball(lit_box(), RoughDielectricMaterial({.alpha = 0.3F})), {2, 5}},
        {"caustic", with_ball(lit_box(), DielectricMaterial({})), {2, 5}},
        {"mirror", with_ball(lit_box(), ConductorMaterial({}))},
        {"smooth_plastic", with_ball(lit_box(), PlasticMaterial({}))},
        {"point_light", with_point_light(test::open_box())},
        {"caustic_of_point_light",
         with_ball(with_point_light(test::open_box()), DielectricMaterial({})),
         {2, 5}},
        {"spot_light", spot_light()},
        {"directional_light", directional_light()},
        {"environment", environment(), {1, 4}},
        {"opacity_mask", opacity_mask()},
        {"textured_blend", textured_blend()},
        {"thin_lens", thin_lens()},
        {"shading_normals", shading_normals()},
    };
}

// Of lights and surfaces of every kind, direct light apart: there are methods for it alone.
const std::vector<Row>& rows() {
    static const std::vector<Row> kRows = [] {
        std::vector<Row> all = scenes();
        for (const std::string name :
             {"glossy_walls", "rough_glass", "smooth_plastic", "point_light", "directional_light",
              "environment", "opacity_mask", "textured_blend", "thin_lens"}) {
            const auto found = std::find_if(all.begin(), all.end(),
                                            [&](const Row& row) { return row.name == name; });
            all.push_back({name + "_directly", found->scene, {1, 2}, 6});
        }
        return all;
    }();
    return kRows;
}

class EveryScene : public testing::TestWithParam<std::size_t> {};

TEST_P(EveryScene, LooksTheSameByAllEstimators) {
    const Row& row = rows()[GetParam()];
    const Scene scene(row.scene, 1);
    test::expect_agreement(
        scene, {.lengths = row.lengths, .width = 32, .height = 24, .samples = row.samples},
        {.scene = row.name,
         .n_seeds = kSeeds,
         .false_discovery_rate = test::sidak(kAlpha, static_cast<int>(rows().size()))},
        kDetectableBias);
}

INSTANTIATE_TEST_SUITE_P(Table, EveryScene, testing::Range(std::size_t{0}, rows().size()),
                         [](const auto& test) { return rows()[test.param].name; });

}  // namespace
}  // namespace misbench
