#include "renderer/scene/inspect.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/methods/catalogue.h"
#include "tests/support/scenes.h"

namespace misbench {
namespace {

using Kind = SceneWarning::Kind;
using testing::AllOf;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

constexpr Rgb kGrey{0.5F, 0.5F, 0.5F};

MATCHER_P2(Warns, kind, object, "") { return arg.kind == kind && arg.object == object; }

std::vector<SceneWarning> check_all(SceneDescription description) {
    std::vector<SceneWarning> warnings = check_description(description);
    const std::vector<SceneObject> objects = scene_objects(description);
    const Scene scene(std::move(description), 1);
    for (const SceneWarning& warning : check_scene(scene, objects)) warnings.push_back(warning);
    return warnings;
}

SceneDescription cornell_box() {
    return import_scene(std::string(MISBENCH_SCENES) + "/CornellBox/CornellBox.json");
}

Transform scale_and_move(float scale, Vec3 to) {
    Transform t;
    t.rows = {{{scale, 0, 0, to.x}, {0, scale, 0, to.y}, {0, 0, scale, to.z}}};
    return t;
}

// The furnace's walls as one mesh with corners of its own for each face. Looks inwards, or outwards
// where turned.
SceneDescription box_of_one_mesh(Rgb emission, bool turned) {
    SceneDescription scene = test::furnace(DiffuseMaterial{kGrey}, emission);
    Mesh all;
    all.emission = emission;
    for (const Mesh& wall : scene.meshes) {
        const auto first = static_cast<std::uint32_t>(all.positions.size());
        all.positions.insert(all.positions.end(), wall.positions.begin(), wall.positions.end());
        for (auto [a, b, c] : wall.triangles) {
            if (turned) std::swap(b, c);
            all.triangles.push_back({first + a, first + b, first + c});
        }
    }
    scene.meshes = {all};
    return scene;
}

void turn_over(Mesh& mesh) {
    for (TriangleIndices& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
    for (Vec3& normal : mesh.normals) normal = -normal;
}

// A floor that a lamp lights from above; the lamp is mesh 1. The camera stands aside.
SceneDescription lit_floor() { return test::floor_under_lamp(kGrey, {1, 1, 1}); }

// --- facts ---------------------------------------------------------------------------------------

TEST(SceneFacts, CountWhatSurfacesUse) {
    SceneDescription description = lit_floor();
    SurfaceMaterial layered = test::surface(DiffuseMaterial{kGrey});
    layered.front.other = Layer{.material = GenericMaterial(GenericMaterial::Parameters{})};
    layered.back = SurfaceMaterial::Back::Other;
    layered.other_back = Side{.layer = {.material = DiffuseMaterial{kGrey}}};
    layered.opacity.value = 0.5F;
    SurfaceMaterial black_back = test::surface(DiffuseMaterial{kGrey});
    black_back.back = SurfaceMaterial::Back::Black;
    const SurfaceMaterial unused = test::surface(GenericMaterial(GenericMaterial::Parameters{}));
    description.materials.insert(description.materials.end(), {layered, black_back, unused});
    description.quadrics.push_back(
        {.to_world = scale_and_move(2, {0, 9, 0}), .material = 2, .emission = {1, 2, 3}});
    description.quadrics.push_back({.shape = Quadric::Shape::Disk, .material = 3});
    description.point_lights.push_back({{0, 5, 0}, {1, 1, 1}});
    description.n_instances = 7;
    description.notes = {"a note"};
    description.meshes[0].triangles.push_back({0, 0, 1});

    const LoadedScene loaded = build_scene(std::move(description), 1);
    const SceneFacts facts = inspect(loaded);
    EXPECT_THAT(loaded.notes, ElementsAre("a note"));
    EXPECT_EQ(facts.n_triangles, 4U);
    EXPECT_EQ(facts.n_degenerate_triangles, 1U);
    EXPECT_EQ(facts.n_instances, 7U);
    EXPECT_THAT(facts.quadrics, ElementsAre(Pair("disk", 1U), Pair("sphere", 1U)));
    EXPECT_EQ(facts.n_materials, 4U);
    EXPECT_THAT(facts.materials, ElementsAre(Pair("diffuse", MaterialUse{4, 1, 0}),
                                             Pair("generic", MaterialUse{0, 0, 1})));
    EXPECT_EQ(facts.n_black_backs, 1U);
    EXPECT_EQ(facts.n_other_backs, 1U);
    EXPECT_EQ(facts.n_blends, 1U);
    EXPECT_EQ(facts.n_with_opacity, 1U);
    EXPECT_THAT(facts.lobes, ElementsAre("diffuse", "glossy", "delta", "transmissive"));
    EXPECT_EQ(facts.n_lights(), 4U);
    EXPECT_EQ(facts.lights.at("triangle").n, 2U);
    EXPECT_EQ(facts.lights.at("sphere").n, 1U);
    EXPECT_EQ(facts.lights.at("point").n, 1U);
    // π · 16 π m² · 3; the lamp's area · π; 4 π.
    const float lamp = 4 * test::kLampHalfWidth * test::kLampHalfDepth * kPi;
    EXPECT_NEAR(facts.lights.at("sphere").power.b, 48 * kPi * kPi, 1e-2F);
    EXPECT_NEAR(facts.power().r, 16 * kPi * kPi + lamp + 4 * kPi, 1e-2F);
    EXPECT_GT(facts.n_geometry_bytes, 9 * sizeof(Vec3) + 4 * sizeof(TriangleIndices));
    EXPECT_THAT(names(loaded.scene->features()),
                ElementsAre("layers", "delta_lobes", "transmission", "delta_lights", "quadrics"));
}

TEST(SceneFacts, AMethodSaysWhatItMisses) {
    EXPECT_EQ(find_method("path").limits({}), "");
    EXPECT_THAT(find_method("path").limits({.delta_lights = true}), HasSubstr("nee=false"));
    EXPECT_THAT(find_method("direct").limits({}), HasSubstr("direct light only"));
    EXPECT_THAT(find_method("direct").limits({.delta_lobes = true}), HasSubstr("bsdf_samples=0"));
}

// --- no false alarms -----------------------------------------------------------------------------

TEST(SceneCheck, ScenesWithoutDefectsGiveNoWarning) {
    EXPECT_THAT(check_all(test::furnace(DiffuseMaterial{kGrey}, {1, 1, 1})), IsEmpty());
    EXPECT_THAT(check_all(box_of_one_mesh({1, 1, 1}, false)), IsEmpty());
    EXPECT_THAT(check_all(lit_floor()), IsEmpty());
    for (const char* scene :
         {"Box/LightCenter.json", "Box/LightTop.json", "CornellBox/CornellBox.json",
          "VeachMIS/VeachMIS.json", "cornell-box/scene.xml", "veach-mis/scene.xml"}) {
        const std::string file = std::string(MISBENCH_SCENES) + "/" + scene;
        EXPECT_THAT(check_all(import_scene(file)), IsEmpty()) << scene;
    }
}

// --- triangles -----------------------------------------------------------------------------------

TEST(SceneCheck, TrianglesWithoutAreaAreCounted) {
    SceneDescription scene = lit_floor();
    scene.meshes[0].triangles.push_back({1, 1, 2});
    scene.meshes[0].triangles.push_back({1, 2, 1});
    const auto warnings = check_all(scene);
    ASSERT_THAT(warnings, ElementsAre(Warns(Kind::DegenerateTriangles, "mesh 0")));
    EXPECT_EQ(warnings[0].message, "2 triangles have no area");
}

TEST(SceneCheck, AnEmitterNeedsAnArea) {
    SceneDescription scene = lit_floor();
    scene.meshes[1].name = "lamp";
    scene.materials[1].name = "glow";
    scene.meshes[1].triangles.push_back({1, 1, 2});
    auto warnings = check_all(scene);
    ASSERT_THAT(warnings,
                ElementsAre(Warns(Kind::EmitterWithoutArea, "mesh 1 'lamp' (material 'glow')")));
    EXPECT_EQ(warnings[0].message, "1 triangle has no area and cannot emit");

    scene.meshes[1].triangles = {{1, 1, 2}};
    warnings = check_all(scene);
    EXPECT_THAT(
        warnings,
        ElementsAre(AllOf(Warns(Kind::EmitterWithoutArea, "mesh 1 'lamp' (material 'glow')"),
                          Field(&SceneWarning::message, "it emits, but has no area")),
                    Warns(Kind::NoLight, "")));
}

TEST(SceneCheck, CopiesOfTrianglesAreFoundInAnyOrderOfCorners) {
    SceneDescription scene = lit_floor();
    Mesh copy = scene.meshes[0];
    copy.positions = {{50, -0.0F, -50}, {-50, 0, 50}, {50, 0, 50}};
    copy.triangles = {{1, 0, 2}};
    scene.meshes.push_back(copy);
    const auto warnings = check_all(scene);
    ASSERT_THAT(warnings, ElementsAre(Warns(Kind::DuplicateTriangles, "mesh 2")));
    EXPECT_EQ(warnings[0].message, "1 triangle has the same corners as others of mesh 0");

    scene.meshes.pop_back();
    scene.meshes[0].triangles.push_back(scene.meshes[0].triangles[1]);
    EXPECT_THAT(check_all(scene), ElementsAre(Warns(Kind::DuplicateTriangles, "mesh 0")));
}

TEST(SceneCheck, NeighboursMustWindAlike) {
    SceneDescription scene = lit_floor();
    std::swap(scene.meshes[0].triangles[1][0], scene.meshes[0].triangles[1][1]);
    const auto warnings = check_all(scene);
    ASSERT_THAT(warnings, ElementsAre(Warns(Kind::WindingConflict, "mesh 0")));
    EXPECT_THAT(warnings[0].message, HasSubstr("1 edge lies"));
}

TEST(SceneCheck, AnEdgeBelongsToTwoTrianglesAtMost) {
    SceneDescription scene = lit_floor();
    Mesh& floor = scene.meshes[0];
    // A fin over the diagonal, with vertices of its own.
    const Vec3 a = floor.positions[0];
    const Vec3 b = floor.positions[2];
    floor.positions.insert(floor.positions.end(), {a, b, {0, 0.5F, 0}});
    floor.triangles.push_back({4, 5, 6});
    const auto warnings = check_all(scene);
    ASSERT_THAT(warnings, ElementsAre(Warns(Kind::SharedEdges, "mesh 0")));
    EXPECT_THAT(warnings[0].message, HasSubstr("1 edge belongs"));
}

TEST(SceneCheck, CornerNormalsFollowTheWinding) {
    SceneDescription scene = lit_floor();
    Mesh& floor = scene.meshes[0];
    floor.normals = {{0, 1, 0}, {0, 1, 0}, {0, 1, 0}, normalized({1, 1e-5F, 0})};
    EXPECT_THAT(check_all(scene), IsEmpty());
    floor.normals[3] = {0, -1, 0};
    auto warnings = check_all(scene);
    ASSERT_THAT(warnings, ElementsAre(Warns(Kind::OpposedNormals, "mesh 0")));
    EXPECT_EQ(warnings[0].message,
              "1 triangle has corner normals that oppose their winding, 0 of them at all three "
              "corners");
    floor.normals.clear();
    scene.meshes[1].normals.assign(4, {0, 1, 0});
    warnings = check_description(scene);
    ASSERT_THAT(warnings, ElementsAre(Warns(Kind::OpposedEmitterNormals, "mesh 1")));
    EXPECT_THAT(warnings[0].message, HasSubstr("2 of them at all three corners"));
}

TEST(SceneCheck, ATexturedMeshNeedsUv) {
    SceneDescription scene = lit_floor();
    scene.textures = {CheckerboardTexture{{0, 0, 0}, {1, 1, 1}}};
    scene.materials[0].front.layer.color_texture = 0;
    EXPECT_THAT(check_description(scene), ElementsAre(Warns(Kind::MissingUv, "mesh 0")));
    scene.meshes[0].uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    EXPECT_THAT(check_description(scene), IsEmpty());
}

TEST(SceneCheck, AMeshIsClosedWhereVerticesOfOnePositionCloseIt) {
    EXPECT_TRUE(scene_objects(box_of_one_mesh({}, true))[0].is_closed);
    SceneDescription open = box_of_one_mesh({}, true);
    open.meshes[0].triangles.pop_back();
    EXPECT_FALSE(scene_objects(open)[0].is_closed);
    SceneDescription twisted = box_of_one_mesh({}, true);
    std::swap(twisted.meshes[0].triangles[3][0], twisted.meshes[0].triangles[3][1]);
    EXPECT_FALSE(scene_objects(twisted)[0].is_closed);
}

// --- lights --------------------------------------------------------------------------------------

TEST(SceneCheck, ACeilingLightThatLooksIntoTheCeilingIsFlipped) {
    SceneDescription scene = cornell_box();
    turn_over(scene.meshes[0]);
    EXPECT_THAT(check_all(scene),
                ElementsAre(Warns(Kind::FlippedEmitter, "mesh 0 'mesh0' (material 'Light')")));
}

TEST(SceneCheck, AnObjectThatShinesOnItselfIsFlipped) {
    // A closed lamp over a floor.
    SceneDescription scene = box_of_one_mesh({1, 1, 1}, false);
    scene.materials.push_back(test::surface(DiffuseMaterial{kGrey}));
    scene.meshes.push_back(test::quad({-9, -3, 9}, {9, -3, 9}, {9, -3, -9}, {-9, -3, -9}, 1));
    scene.camera.to_world = scale_and_move(1, {0, 0, 8});
    EXPECT_THAT(check_all(scene), ElementsAre(Warns(Kind::FlippedEmitter, "mesh 0")));
    turn_over(scene.meshes[0]);
    EXPECT_THAT(check_all(scene), IsEmpty());

    scene.meshes.erase(scene.meshes.begin());
    scene.quadrics = {{.flipped = true, .name = "bulb", .emission = {1, 1, 1}}};
    EXPECT_THAT(check_all(scene), ElementsAre(Warns(Kind::FlippedEmitter, "sphere 0 'bulb'")));
    scene.quadrics[0].flipped = false;
    EXPECT_THAT(check_all(scene), IsEmpty());
}

TEST(SceneCheck, ALampThatLightsAWallFromSomeDistanceIsNotFlipped) {
    SceneDescription scene = cornell_box();
    Mesh& lamp = scene.meshes[0];
    // As far from the ceiling as the box's own lamp, but much smaller than that.
    lamp = test::quad({-0.005F, 1.98F, 0.005F}, {0.005F, 1.98F, 0.005F}, {0.005F, 1.98F, -0.005F},
                      {-0.005F, 1.98F, -0.005F}, lamp.material, lamp.emission);
    EXPECT_THAT(check_all(scene), IsEmpty());
    // Nearly as large as the back wall and nearer to it than its own size, but not close to it.
    lamp = test::quad({0.9F, 0.1F, -0.7F}, {-0.9F, 0.1F, -0.7F}, {-0.9F, 1.9F, -0.7F},
                      {0.9F, 1.9F, -0.7F}, lamp.material, lamp.emission);
    EXPECT_THAT(check_all(scene), IsEmpty());
}

TEST(SceneCheck, ALampThatShinesIntoTheOpenIsNotFlipped) {
    SceneDescription scene = test::floor_under_lamp(kGrey, {1, 1, 1}, true);
    EXPECT_THAT(check_all(scene), IsEmpty());
    scene.meshes[1].emission = {};
    EXPECT_THAT(check_all(scene), ElementsAre(Warns(Kind::NoLight, "")));
}

// --- camera --------------------------------------------------------------------------------------

TEST(SceneCheck, ACameraInAClosedOpaqueObjectSeesNothingElse) {
    SceneDescription scene = box_of_one_mesh({}, true);
    scene.point_lights.push_back({{0, 0.5F, 0}, {1, 1, 1}});
    EXPECT_THAT(check_all(scene), ElementsAre(Warns(Kind::CameraInside, "mesh 0")));

    // Outside of it; in a room that looks inwards; in one whose walls look outwards; in a room that
    // something else stands in; in something transparent.
    SceneDescription outside = scene;
    outside.camera.to_world = scale_and_move(1, {0, 0, 5});
    EXPECT_THAT(check_all(outside), IsEmpty());
    SceneDescription room = scene;
    turn_over(room.meshes[0]);
    EXPECT_THAT(check_all(room), IsEmpty());
    SceneDescription walls = test::furnace(DiffuseMaterial{kGrey}, {});
    walls.point_lights = scene.point_lights;
    for (Mesh& wall : walls.meshes) turn_over(wall);
    EXPECT_THAT(check_all(walls), IsEmpty());
    SceneDescription furnished = scene;
    furnished.quadrics.push_back({.to_world = scale_and_move(0.2F, {0, 0, -0.7F})});
    EXPECT_THAT(check_all(furnished), IsEmpty());
    SceneDescription glass = scene;
    glass.materials[0].opacity.value = 0.5F;
    EXPECT_THAT(check_all(glass), IsEmpty());
}

TEST(SceneCheck, ACameraKeepsItsDistance) {
    SceneDescription scene = test::furnace(DiffuseMaterial{kGrey}, {1, 1, 1});
    scene.camera.to_world = scale_and_move(1, {0, -0.999F, 0});
    EXPECT_THAT(check_all(scene), IsEmpty());
    scene.camera.to_world = scale_and_move(1, {0, -0.9999F, 0});
    EXPECT_THAT(check_all(scene), ElementsAre(Warns(Kind::CameraTooClose, "mesh 0")));
    scene.camera.to_world =
        scale_and_move(1, {0.5F, 0.9999F, -0.5F});  // the first of its triangles
    EXPECT_THAT(check_all(scene), ElementsAre(Warns(Kind::CameraTooClose, "mesh 1")));
}

}  // namespace
}  // namespace misbench
