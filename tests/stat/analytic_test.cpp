// Images whose radiance is known in closed form, by every way of estimating them.
#include <gtest/gtest.h>

#include "renderer/methods/render_loop.h"
#include "tests/support/scenes.h"
#include "tests/support/statistics.h"

namespace misbench {
namespace {

// One false alarm among all comparisons of this binary with this probability.
constexpr double kAlpha = 0.01;
constexpr int kSeeds = 16;
constexpr int kComparisons = 40;  // at the most

struct Estimator {
    const char* name;
    const char* method;
    ParameterMap parameters;
};

const Estimator kMis = {"mis", "path", {{"max_depth", std::int64_t{2}}}};
const Estimator kNee = {"nee", "path", {{"bsdf", false}, {"max_depth", std::int64_t{2}}}};
const Estimator kTree = {
    "tree",
    "path",
    {{"bsdf", false}, {"max_depth", std::int64_t{2}}, {"light_selection", std::string("tree")}}};
const Estimator kBsdf = {"bsdf", "path", {{"nee", false}, {"max_depth", std::int64_t{2}}}};
const Estimator kDirect = {
    "direct", "direct", {{"light_samples", std::int64_t{2}}, {"bsdf_samples", std::int64_t{1}}}};

RenderResult image_of(const Scene& scene, const Estimator& estimator, std::int64_t seed,
                      std::int64_t samples) {
    return render(scene, {.method = estimator.method,
                          .parameters = estimator.parameters,
                          .width = 8,
                          .height = 8,
                          .budget = SampleBudget{samples},
                          .seed = seed,
                          .threads = 2});
}

double mean_of(const Image& image) {
    double mean = 0;
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
        mean += double{image.rgb[i]} / static_cast<double>(image.n_pixels());
    }
    return mean;
}

void expect_mean(const Scene& scene, const Estimator& estimator, double expected,
                 std::int64_t samples = 64) {
    std::vector<double> means;
    for (int seed = 0; seed < kSeeds; ++seed) {
        const RenderResult result = image_of(scene, estimator, 500 + seed, samples);
        ASSERT_TRUE(result.valid) << estimator.name;
        means.push_back(mean_of(result.image));
    }
    EXPECT_GT(test::p_value_of_mean(means, expected), test::sidak(kAlpha, kComparisons))
        << estimator.name << ": " << means[0] << " expected " << expected;
}

PerspectiveCamera camera_at(Vec3 position, Vec3 target, float fov_degrees) {
    const Vec3 z = normalized(position - target);
    const Vec3 x = normalized(cross(std::abs(z.y) > 0.9F ? Vec3{1, 0, 0} : Vec3{0, 1, 0}, z));
    const Vec3 y = cross(z, x);
    PerspectiveCamera camera;
    camera.to_world.rows = {
        {{x.x, y.x, z.x, position.x}, {x.y, y.y, z.y, position.y}, {x.z, y.z, z.z, position.z}}};
    camera.fov_degrees = fov_degrees;
    return camera;
}

constexpr float kRho = 0.7F;

// A Lambert floor at y = 0, seen at the origin only, through a needle's eye.
SceneDescription floor_scene() {
    SceneDescription scene;
    scene.materials = {test::surface(DiffuseMaterial{{kRho, kRho, kRho}}),
                       test::surface(DiffuseMaterial{})};
    const float r = 20;
    scene.meshes.push_back(test::quad({-r, 0, r}, {r, 0, r}, {r, 0, -r}, {-r, 0, -r}, 0));
    scene.camera = camera_at({3, 1, 0}, {0, 0, 0}, 0.01F);
    return scene;
}

Quadric lamp(Quadric::Shape shape, const Transform& to_world) {
    return {
        .shape = shape, .to_world = to_world, .name = "lamp", .material = 1, .emission = {5, 5, 5}};
}

// E = π L r² / d² cos θ under a sphere that lies above the horizon of the point.
TEST(AnalyticImage, OfASphereLightOverAFloor) {
    SceneDescription description = floor_scene();
    Transform t;
    t.rows = {{{0.5F, 0, 0, 1}, {0, 0.5F, 0, 2}, {0, 0, 0.5F, 0}}};
    description.quadrics = {lamp(Quadric::Shape::Sphere, t)};
    const Scene scene(description, 1);
    const double d2 = 5;
    const double expected = double{kRho} * 5 * 0.25 / d2 * (2 / std::sqrt(d2));
    for (const Estimator& e : {kMis, kNee, kTree, kBsdf, kDirect}) expect_mean(scene, e, expected);
}

// E = π L r² / (r² + h²) below the middle of a disk.
TEST(AnalyticImage, OfADiskLightOverAFloor) {
    SceneDescription description = floor_scene();
    Transform t;
    t.rows = {{{0.8F, 0, 0, 0}, {0, 0, -1, 1.5F}, {0, 0.8F, 0, 0}}};
    description.quadrics = {lamp(Quadric::Shape::Disk, t)};
    const Scene scene(description, 1);
    const double expected = double{kRho} * 5 * 0.64 / (0.64 + 2.25);
    for (const Estimator& e : {kMis, kNee, kTree, kBsdf, kDirect}) expect_mean(scene, e, expected);
}

TEST(AnalyticImage, OfPointSpotAndDirectionalLights) {
    const double rho_pi = double{kRho} / M_PI;
    SceneDescription description = floor_scene();
    description.point_lights = {{.position = {0, 2, 1}, .intensity = {3, 3, 3}}};
    {
        const Scene scene(description, 1);
        const double expected = rho_pi * 3 * 2 / std::pow(5, 1.5);
        for (const Estimator& e : {kMis, kNee, kTree, kDirect}) expect_mean(scene, e, expected);
    }
    description.point_lights.clear();
    // The floor lies half-way between the beam (20°) and the cutoff (40°) of the spot.
    const float angle = 30 * kPi / 180;
    description.spot_lights = {{.position = {0, 2, 0},
                                .direction = {std::sin(angle), -std::cos(angle), 0},
                                .intensity = {3, 3, 3},
                                .cutoff_angle = 40 * kPi / 180,
                                .beam_width = 20 * kPi / 180}};
    {
        const Scene scene(description, 1);
        for (const Estimator& e : {kMis, kNee, kTree, kDirect}) {
            expect_mean(scene, e, rho_pi * 3 * 0.5 / 4);
        }
    }
    description.spot_lights.clear();
    description.directional_lights = {
        {.direction = normalized({1, -1, 0}), .irradiance = {3, 3, 3}}};
    const Scene scene(description, 1);
    for (const Estimator& e : {kMis, kNee, kTree, kDirect}) {
        expect_mean(scene, e, rho_pi * 3 * std::sqrt(0.5));
    }
}

std::shared_ptr<const Image> constant_map(float value) {
    Image image(1, 1);
    image.rgb = {value, value, value};
    return std::make_shared<const Image>(std::move(image));
}

TEST(AnalyticImage, OfAConstantEnvironmentOverAFloor) {
    SceneDescription description = floor_scene();
    description.environment = EnvironmentDescription{.radiance = constant_map(2)};
    const Scene scene(description, 1);
    for (const Estimator& e : {kMis, kNee, kTree, kBsdf, kDirect}) {
        expect_mean(scene, e, double{kRho} * 2);
    }
}

// ∫ L cos θ dω over one pixel of 32 × 16: L Δφ (sin² θ_1 - sin² θ_0) / 2.
TEST(AnalyticImage, OfAnEnvironmentOfOneHotTexelOverAFloor) {
    SceneDescription description = floor_scene();
    Image image(32, 16);
    for (std::size_t c = 0; c < 3; ++c) image.rgb[3 * (32 * 4 + 7) + c] = 1e6F;
    description.environment =
        EnvironmentDescription{.radiance = std::make_shared<const Image>(std::move(image))};
    const Scene scene(description, 1);
    const double s0 = std::sin(4 * M_PI / 16);
    const double s1 = std::sin(5 * M_PI / 16);
    const double expected = double{kRho} / M_PI * 1e6 * (2 * M_PI / 32) * (s1 * s1 - s0 * s0) / 2;
    for (const Estimator& e : {kMis, kNee, kTree, kDirect}) expect_mean(scene, e, expected);
}

// Glass in a sky of 1 everywhere is invisible: nothing is absorbed, and what refraction squeezes it
// spreads again.
TEST(AnalyticImage, OfAGlassBallInAFurnace) {
    SceneDescription description;
    for (const float eta : {1.0001F, 1.5F, 1 / 1.5F, 3.0F}) {
        description.materials = {test::surface(DielectricMaterial({.eta = eta}))};
        description.quadrics = {{.name = "ball", .material = 0}};
        description.environment = EnvironmentDescription{.radiance = constant_map(1)};
        description.camera = camera_at({0, 0, 4}, {0, 0, 0}, 40);
        const Scene scene(description, 1);
        const Estimator long_paths = {
            "path", "path", {{"max_depth", std::int64_t{200}}, {"rr_depth", std::int64_t{20}}}};
        expect_mean(scene, long_paths, 1, 64);
    }
}

// A mirror shows a lamp with its own colour.
TEST(AnalyticImage, OfALampInAMirror) {
    SceneDescription description;
    description.materials = {
        test::surface(ConductorMaterial({.specular_reflectance = {0.9F, 0.6F, 0.3F}})),
        test::surface(DiffuseMaterial{})};
    description.meshes.push_back(test::quad({-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}, 0));
    description.meshes.push_back(
        test::quad({-2, 3, -2}, {2, 3, -2}, {2, 3, 2}, {-2, 3, 2}, 1, {5, 5, 5}));
    description.camera = camera_at({0, 1, 0.1F}, {0, 0, 0}, 20);
    const Scene scene(description, 1);
    for (const Estimator& e : {kMis, kNee, kBsdf}) {
        const Image image = image_of(scene, e, 1, 4).image;
        for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
            ASSERT_NEAR(image.rgb[i], 4.5F, 1e-4F) << e.name;
            ASSERT_NEAR(image.rgb[i + 1], 3.0F, 1e-4F) << e.name;
            ASSERT_NEAR(image.rgb[i + 2], 1.5F, 1e-4F) << e.name;
        }
    }
}

// The form factor of two parallel unit squares at distance 1 (contour integration over both).
TEST(AnalyticImage, OfTwoParallelPlates) {
    const double root = std::sqrt(2.0);
    const double form_factor =
        2 / M_PI * (std::log(std::sqrt(4.0 / 3)) + 2 * root * std::atan(1 / root) - M_PI / 2);
    SceneDescription description;
    description.materials = {test::surface(DiffuseMaterial{{kRho, kRho, kRho}}),
                             test::surface(DiffuseMaterial{})};
    const float r = 0.5F;
    description.meshes.push_back(test::quad({-r, 0, r}, {r, 0, r}, {r, 0, -r}, {-r, 0, -r}, 0));
    description.meshes.push_back(
        test::quad({-r, 1, -r}, {r, 1, -r}, {r, 1, r}, {-r, 1, r}, 1, {5, 5, 5}));
    // From half-way between the plates the film is just filled by the lower one, all of whose
    // points cover equal parts of it.
    description.camera = camera_at({0, 0.5F, 0}, {0, 0, 0}, 90);
    const Scene scene(description, 1);
    for (const Estimator& e : {kMis, kNee, kBsdf, kDirect}) {
        expect_mean(scene, e, double{kRho} * 5 * form_factor);
    }
}

}  // namespace
}  // namespace misbench
