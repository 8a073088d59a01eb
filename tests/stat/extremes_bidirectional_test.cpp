// Light paths in the scenes of experiments/extremes: the bidirectional methods against right
// answers in closed form where there are some, else against the path tracer.
#include <gtest/gtest.h>

#include "renderer/scene/load.h"
#include "renderer/scene/scene.h"
#include "tests/support/extremes.h"
#include "tests/support/statistics.h"

namespace misbench {
namespace {

using extremes::scaled;
using extremes::translated;
using extremes::turned;
using test::extreme_scene;
using test::floor_radiance;
using test::Frame2;
using test::image_by;
using test::mean_of;
using test::white_box_radiance;

// One false alarm among all comparisons of this binary with this probability.
constexpr double kAlpha = 0.01;
constexpr int kComparisons = 50;  // at the most
const double kLevel = test::sidak(kAlpha, kComparisons);
constexpr int kSeeds = 24;

struct Method {
    std::string name;
    ParameterMap parameters{};
};
std::ostream& operator<<(std::ostream& out, const Method& method) {
    out << method.name;
    for (const auto& [key, value] : method.parameters) out << ' ' << key << '=' << to_string(value);
    return out;
}

const ParameterValue kPath = std::string("path");
const ParameterValue kGlobal = std::string("global");
const ParameterValue kFloat = std::string("float");

const Method kBdpt = {"bdpt"};
const Method kPaired = {"bdpt", {{"pairing", kPath}}};
const Method kVcm = {"vcm"};
// A radius whose bias hides in the noise.
const Method kNarrowVcm = {"vcm", {{"radius_scale", 0.02}, {"merge_first", true}}};

Method with(Method method, const ParameterMap& parameters) {
    for (const auto& [key, value] : parameters) method.parameters[key] = value;
    return method;
}

Image image_of(const Scene& scene, const Method& method, Frame2 frame, std::int64_t seed = 1) {
    return image_by(method.name, scene, method.parameters, frame, seed);
}

void expect_mean(const Scene& scene, const Method& method, double expected, Frame2 frame,
                 int seeds = kSeeds) {
    const std::vector<double> values =
        test::means_by(method.name, scene, method.parameters, frame, seeds);
    EXPECT_GT(test::p_value_of_mean(values, expected), kLevel)
        << method << ": " << values[0] << " " << values[1] << " ... instead of " << expected;
}

// The two methods have the same mean, each with its own noise.
void expect_equal_means(const Scene& scene, const Method& a, Frame2 frame_a, const Method& b,
                        Frame2 frame_b) {
    const std::vector<double> of_a = test::means_by(a.name, scene, a.parameters, frame_a, kSeeds);
    const std::vector<double> of_b = test::means_by(b.name, scene, b.parameters, frame_b, kSeeds);
    double mean_of_a = 0;
    for (const double value : of_a) mean_of_a += value / kSeeds;
    std::vector<double> ratios;
    for (std::size_t i = 0; i < of_a.size(); ++i) {
        ratios.push_back(1 + (of_b[i] - of_a[i]) / mean_of_a);
    }
    EXPECT_GT(test::p_value_of_mean(ratios, 1), kLevel) << a << " and " << b;
}

// ---- Paths of a hundred edges. They have 198 techniques, whose densities span hundreds of
// decades.

const ParameterMap kHundredEdges = {{"max_depth", std::int64_t{100}},
                                    {"rr_depth", std::int64_t{0}}};

TEST(WhiteBox, IsRightOverAHundredEdgesByEveryTechnique) {
    const Scene scene(turned(extremes::white_box(0.9F)), 1);
    const double expected = white_box_radiance(double{0.9F}, 100);
    const ParameterMap only = {
        {"hit", false}, {"nee", false}, {"light", false}, {"connect", false}};
    const auto by = [&](const Method& method, const ParameterMap& parameters) {
        // With pairing every vertex of a path meets every one of another.
        const bool is_paired = method.parameters.contains("pairing");
        expect_mean(scene, with(with(method, kHundredEdges), parameters), expected,
                    is_paired ? Frame2{4, 4, 1} : Frame2{6, 6, 2}, 16);
    };
    by({"light"}, {});
    by(kBdpt, {});
    by(kPaired, {});
    by(kNarrowVcm, {});
    by(kBdpt, {{"densities", kFloat}});
    by(kNarrowVcm, {{"densities", kFloat}});
    for (const char* technique : {"nee", "light", "connect"}) {
        ParameterMap two = only;
        two["hit"] = true;
        two[technique] = true;
        by(kBdpt, two);
    }
    ParameterMap merging = only;
    merging["hit"] = true;
    by(kNarrowVcm, merging);
}

// At scales where a hundred densities leave the range of doubles too.
TEST(WhiteBox, IsRightInPathsOfExactlyAHundredEdgesAtEveryScale) {
    const SceneDescription box = turned(extremes::white_box(0.999F));
    const double expected = std::pow(double{0.999F}, 99);
    const ParameterMap in_float = {{"densities", kFloat}};
    for (const float scale : {1e-6F, 1.0F, 1e6F}) {
        const Scene scene(scaled(box, scale), 1);
        for (const Method& method : {Method{"light"}, kBdpt, kPaired, kNarrowVcm,
                                     with(kBdpt, in_float), with(kNarrowVcm, in_float)}) {
            expect_mean(scene,
                        with(with(method, kHundredEdges), {{"min_depth", std::int64_t{100}}}),
                        expected, {8, 8, 1});
        }
    }
}

TEST(OneEdge, IsAllThatIsSeenAtDepthOne) {
    const Scene scene(turned(extremes::room()), 1);
    const ParameterMap depth = {{"max_depth", std::int64_t{1}}};
    const Image image = image_of(scene, with({"path"}, depth), {32, 32, 4});
    for (const char* method : {"light", "bdpt", "photon", "vcm"}) {
        EXPECT_EQ(image_of(scene, with({method}, depth), {32, 32, 4}), image) << method;
    }
}

// ---- Lights.

TEST(Lamp, IlluminatesTheFloorByItsFormFactor) {
    const Scene scene(turned(extremes::floor_and_lamp({})), 1);
    for (const Method& method : {kBdpt, kPaired, kVcm}) {
        expect_mean(scene, method, floor_radiance({}), {16, 16, 4});
    }
}

TEST(TinyLight, IlluminatesTheFloorInProportionToItsArea) {
    const SceneDescription description = extreme_scene("tiny-light");
    const double expected = test::tiny_lamp_radiance(double{extremes::kTinyLampRadiance},
                                                     test::area_of(description.meshes[1]),
                                                     double{extremes::kTinyLampHeight});
    const Scene scene(description, 1);
    for (const Method& method : {kBdpt, kVcm, with(kVcm, {{"densities", kFloat}})}) {
        EXPECT_NEAR(mean_of(image_of(scene, method, {16, 16, 8})), expected, 5e-4 * expected);
    }
}

// A lamp whose corners are neighbours among floats: all points on it are rounded to its corners.
TEST(LampOfOneSpacing, IlluminatesTheFloorInProportionToItsArea) {
    constexpr float kFar = 0x1p17F;
    constexpr float kSpacing = 0x1p-6F;
    ASSERT_EQ(std::nextafter(kFar, INFINITY) - kFar, kSpacing);
    constexpr float kRadiance = 1e5F;
    SceneDescription description = translated(extremes::floor_and_lamp({}), {kFar, kFar, kFar});
    description.meshes[1] = extremes::grid({kFar, kFar + 1.5F, kFar}, {kSpacing, 0, 0},
                                           {0, 0, kSpacing}, 1, 1, 1, kRadiance * kWhite);
    const double expected =
        test::tiny_lamp_radiance(double{kRadiance}, double{kSpacing} * double{kSpacing}, 1.5);
    const Scene scene(description, 1);
    for (const Method& method : {Method{"path"}, kBdpt, kPaired, kVcm}) {
        EXPECT_NEAR(mean_of(image_of(scene, method, {16, 16, 8})), expected, 0.01 * expected)
            << method;
    }
}

TEST(MillionLights, ShineLikeOneOfTheirSize) {
    const Scene scene(extreme_scene("million-lights"), 1);
    for (const Method& method : {kBdpt, kVcm}) {
        expect_mean(scene, method, floor_radiance({}), {16, 16, 8}, 6);
    }
}

TEST(NoLight, IsBlackByEveryMethod) {
    const Scene scene(extreme_scene("no-light"), 1);
    for (const Method& method : {Method{"light"}, kBdpt, kPaired, Method{"photon"}, kVcm}) {
        for (const float value : image_of(scene, method, {16, 16, 2}).rgb) EXPECT_EQ(value, 0);
    }
}

// ---- Scales.

TEST(Scale, ByAPowerOfTwoChangesNoBit) {
    const SceneDescription room = turned(extremes::room());
    const Frame2 frame = {32, 32, 2};
    for (const Method& method :
         {Method{"light"}, kBdpt, kPaired, Method{"photon"}, kVcm,
          with(kVcm, {{"radius", kGlobal}, {"radius_scale", 0.01}, {"merge_first", true}}),
          with(kVcm, {{"densities", kFloat}})}) {
        const Image image = image_of(Scene(room, 1), method, frame);
        for (const float scale : {0x1p-20F, 0x1p20F}) {
            EXPECT_EQ(image_of(Scene(scaled(room, scale), 1), method, frame).rgb, image.rgb)
                << method << ' ' << scale;
        }
    }
}

TEST(Scale, ByAMillionChangesRoundingsOnly) {
    const Scene room(turned(extremes::room()), 1);
    for (const Method& method : {kBdpt, kPaired, Method{"photon"}, kVcm}) {
        const Image image = image_of(room, method, {32, 32, 4});
        for (const char* name : {"world-1e-6", "world-1e6"}) {
            const Image other = image_of(Scene(extreme_scene(name), 1), method, {32, 32, 4});
            EXPECT_NEAR(mean_of(other) / mean_of(image), 1, 0.01) << name << ' ' << method;
        }
    }
}

// As for the path tracer in extremes_test.cpp.
TEST(Translation, FarFromTheOriginTheImageIsTheSame) {
    const SceneDescription there = extreme_scene("far-from-origin");
    const SceneDescription here = translated(there, {-1e5F, 1e5F, -1e5F});
    for (const Method& method : {kBdpt, kVcm}) {
        const Image far = image_of(Scene(there, 1), method, {64, 64, 16});
        const Image near = image_of(Scene(here, 1), method, {64, 64, 16});
        EXPECT_NEAR(mean_of(far) / mean_of(near), 1, 0.01) << method;
        EXPECT_LT(test::worst_block(far, near), 0.1) << method;
    }
}

// ---- Counts and radii.

TEST(LightPaths, AnyNumberOfThemHasTheSameMean) {
    const Scene scene(turned(extremes::room()), 1);
    for (const double n : {1.0 / 64, 0.1, 1000.0}) {
        expect_equal_means(scene, {"path"}, {8, 8, 64}, with(kBdpt, {{"light_paths", n}}),
                           {8, 8, n > 1 ? 1 : 32});
    }
}

TEST(Radius, IsFiniteFromAMillionthOfTheSceneToAMillionTimesIt) {
    const Scene scene(turned(extremes::room()), 1);
    for (const double scale : {1e-12, 1e-6, 1e-3, 1.0, 1e6, 1e12}) {
        const ParameterMap radius = {{"radius", kGlobal}, {"radius_scale", scale}};
        for (const char* method : {"photon", "vcm"}) {
            EXPECT_GT(mean_of(image_of(scene, with({method}, radius), {8, 8, 2})), 0)
                << method << ' ' << scale;
        }
    }
}

// At 1e5 units off the origin, places are rounded to 1/128: in a smaller disk photons are found at
// its centre or nowhere.
TEST(Radius, IsRaisedAboveTheRoundingOfPlaces) {
    const SceneDescription there = extreme_scene("far-from-origin");
    const Scene far(there, 1);
    const Scene near(translated(there, {-1e5F, 1e5F, -1e5F}), 1);
    const double expected = mean_of(image_of(near, {"path"}, {16, 16, 64}));
    for (const double scale : {1e-9, 1e-6, 1e-4}) {
        const Method photon = {
            "photon", {{"radius", kGlobal}, {"radius_scale", scale}, {"light_paths", 10.0}}};
        EXPECT_NEAR(mean_of(image_of(far, photon, {16, 16, 16})), expected, 0.05 * expected)
            << scale;
    }
}

// ---- Glass whose lobes are narrower than any connection finds.

SceneDescription caustic_chain(float alpha) {
    SceneDescription scene = import_scene(MISBENCH_EXTREMES "/caustic-chain.xml");
    for (SurfaceMaterial& material : scene.materials) {
        Material& layer = material.front.layer.material;
        if (!std::holds_alternative<RoughDielectricMaterial>(layer)) continue;
        layer = RoughDielectricMaterial(
            {.eta = 1.5F, .distribution = Microfacets::Ggx, .alpha = alpha});
    }
    return scene;
}

TEST(CausticChain, IsTheSameByAllMethods) {
    const ParameterMap depth = {{"max_depth", std::int64_t{12}}, {"rr_depth", std::int64_t{0}}};
    for (const float alpha : {1e-3F, 1e-4F}) {
        const Scene scene(turned(caustic_chain(alpha)), 1);
        for (const Method& method : {kBdpt, kPaired, kNarrowVcm}) {
            expect_equal_means(scene, with({"path", {{"nee", false}}}, depth), {16, 16, 64},
                               with(method, depth), {16, 16, 8});
        }
    }
}

}  // namespace
}  // namespace misbench
