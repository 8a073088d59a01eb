// The scenes of experiments/extremes, each against its right answer: in closed form where there is
// one, else against another scene with the same answer.
#include <gtest/gtest.h>

#include "renderer/scene/light_sampler.h"
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
using test::mean_of;
using test::white_box_radiance;

// One false alarm among all comparisons of this binary with this probability.
constexpr double kAlpha = 0.01;
constexpr int kComparisons = 24;
const double kLevel = test::sidak(kAlpha, kComparisons);
constexpr int kSeeds = 24;

const ParameterMap kBsdf = {{"nee", false}};
const ParameterMap kNee = {{"bsdf", false}};
const ParameterMap kMis = {};

// Paths of exactly as many edges: Russian roulette never begins.
ParameterMap of_depth(std::int64_t depth, ParameterMap parameters) {
    parameters["max_depth"] = depth;
    parameters["rr_depth"] = depth;
    return parameters;
}

Image image_of(const Scene& scene, const ParameterMap& parameters, Frame2 frame,
               std::int64_t seed = 1) {
    return test::image_by("path", scene, parameters, frame, seed);
}

std::vector<double> means(const Scene& scene, const ParameterMap& parameters, Frame2 frame,
                          int seeds = kSeeds) {
    return test::means_by("path", scene, parameters, frame, seeds);
}

void expect_mean(const Scene& scene, const ParameterMap& parameters, double expected,
                 Frame2 frame = {16, 16, 8}, int seeds = kSeeds) {
    const std::vector<double> values = means(scene, parameters, frame, seeds);
    EXPECT_GT(test::p_value_of_mean(values, expected), kLevel)
        << values[0] << " " << values[1] << " ... instead of " << expected;
}

void expect_floor_radiance(const Scene& scene, const extremes::FloorAndLamp& layout) {
    for (const ParameterMap& parameters : {kBsdf, kNee, kMis}) {
        expect_mean(scene, parameters, floor_radiance(layout));
    }
}

// BSDF sampling has no chance to hit it and takes no part.
TEST(TinyLight, IlluminatesTheFloorInProportionToItsArea) {
    const SceneDescription description = extreme_scene("tiny-light");
    const double area = test::area_of(description.meshes[1]);
    EXPECT_NEAR(area, 1e-10, 1e-12);
    const Scene scene(description, 1);
    const double expected = test::tiny_lamp_radiance(double{extremes::kTinyLampRadiance}, area,
                                                     double{extremes::kTinyLampHeight});
    for (const ParameterMap& parameters : {kNee, kMis}) {
        // The lamp's rounded corners tilt it by a hundredth, which takes 1e-4 off its cosine.
        EXPECT_NEAR(mean_of(image_of(scene, parameters, {16, 16, 8})), expected, 5e-4 * expected);
    }
}

TEST(MillionLights, ShineLikeOneOfTheirSize) {
    const Scene scene(extreme_scene("million-lights"), 1);
    ASSERT_EQ(scene.lights().size(), 1'000'000U);
    for (const LightSelection& selection : light_selections()) {
        ParameterMap parameters = kNee;
        parameters["light_selection"] = std::string(selection.name);
        expect_mean(scene, parameters, floor_radiance({}), {16, 16, 16}, 5);
    }
    for (const ParameterMap& parameters : {kBsdf, kMis}) {
        expect_mean(scene, parameters, floor_radiance({}), {16, 16, 16}, 5);
    }
}

TEST(MillionTriangles, AreAFloor) {
    expect_floor_radiance(Scene(extreme_scene("million-triangles"), 1), {});
}

// The barycentric coordinates of a hit err by about the aspect times the distance in roundings: at
// an aspect of 1e6, points slide along their sliver by a few hundredths of its length.
TEST(Slivers, AreAFloorAndALampWithinTwoHundredths) {
    const Scene scene(extreme_scene("slivers"), 1);
    const double expected = floor_radiance({.lamp_width = 1, .lamp_depth = 0.1F});
    for (const ParameterMap& parameters : {kNee, kMis}) {
        EXPECT_NEAR(mean_of(image_of(scene, parameters, {32, 32, 32})), expected, 0.02 * expected);
    }
    EXPECT_NEAR(mean_of(image_of(scene, kBsdf, {64, 64, 64})), expected, 0.05 * expected);
}

TEST(CoincidentSurfaces, AreOne) {
    expect_floor_radiance(Scene(extreme_scene("coincident-surfaces"), 1), {});
}

TEST(ZeroAreaEmitters, AddNothing) {
    expect_floor_radiance(Scene(extreme_scene("zero-area-emitters"), 1), {});
}

TEST(NoLight, IsBlackByEveryTechnique) {
    const Scene scene(extreme_scene("no-light"), 1);
    for (const ParameterMap& parameters : {kBsdf, kNee, kMis}) {
        for (const float value : image_of(scene, parameters, {16, 16, 4}).rgb) EXPECT_EQ(value, 0);
    }
}

// Without Russian roulette every sample has the box's radiance, unless its path leaves through a
// wall.
int pixels_off(const Image& image, double expected, double tolerance) {
    int n = 0;
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
        n += std::abs(double{image.rgb[i]} / expected - 1) < tolerance ? 0 : 1;
    }
    return n;
}

TEST(WhiteBox, IsExactInEveryPixelAfterAThousandEdges) {
    const Scene scene(extreme_scene("white-box"), 1);
    const Image image = image_of(scene, of_depth(1000, kBsdf), {24, 24, 1});
    // A thousand sums in float.
    EXPECT_EQ(pixels_off(image, white_box_radiance(double{0.999F}, 1000), 1e-4), 0);
}

TEST(WhiteBox, IsRightWithRussianRoulette) {
    const Scene scene(turned(extremes::white_box(0.9F)), 1);
    expect_mean(scene, {{"nee", false}, {"max_depth", std::int64_t{10'000}}},
                1 / (1 - double{0.9F}));
}

TEST(WhiteBox, IsExactAtEveryScaleAndFarFromTheOrigin) {
    const double expected = white_box_radiance(0.5, 50);
    const SceneDescription box = turned(extremes::white_box(0.5F));
    for (const float scale : {1e-6F, 1.0F, 1e6F}) {
        for (const float distance : {0.0F, 1.0F, 100.0F, 1e5F}) {
            const Vec3 by{scale * distance, -scale * distance, scale * distance};
            const Scene scene(translated(scaled(box, scale), by), 1);
            const Image image = image_of(scene, of_depth(50, kBsdf), {32, 32, 1});
            // Beside a wall's edge a rounded point may lie behind the next wall, so that a path
            // leaves the box: 1e5 sizes from the origin one path of 50 edges in 40 does.
            const int allowed = distance < 1e5F ? 0 : 32 * 32 / 20;
            EXPECT_LE(pixels_off(image, expected, 1e-5), allowed) << scale << " " << distance;
        }
    }
}

TEST(ImageSize, OnePixelIsTheMeanOfMany) {
    const Scene scene(turned(extremes::room()), 1);
    const std::vector<double> one = means(scene, kMis, {1, 1, 512});
    const std::vector<double> many = means(scene, kMis, {32, 32, 1});
    std::vector<double> differences;
    for (std::size_t i = 0; i < one.size(); ++i) differences.push_back(1 + one[i] - many[i]);
    EXPECT_GT(test::p_value_of_mean(differences, 1), kLevel);
}

TEST(ImageSize, OneRowOf8192PixelsIsExact) {
    const Scene scene(turned(extremes::white_box(0.5F)), 1);
    const Image image = image_of(scene, of_depth(20, kBsdf), {8192, 1, 1});
    ASSERT_EQ(image.n_pixels(), 8192U);
    EXPECT_EQ(pixels_off(image, white_box_radiance(0.5, 20), 1e-5), 0);
}

TEST(Scale, ByAPowerOfTwoChangesNoBit) {
    const SceneDescription room = turned(extremes::room());
    const Image image = image_of(Scene(room, 1), kMis, {48, 48, 4});
    for (const float scale : {0x1p-20F, 0x1p20F}) {
        EXPECT_EQ(image_of(Scene(scaled(room, scale), 1), kMis, {48, 48, 4}).rgb, image.rgb);
    }
}

TEST(Scale, ByAMillionChangesRoundingsOnly) {
    const Image image = image_of(Scene(turned(extremes::room()), 1), kMis, {48, 48, 4});
    for (const char* name : {"world-1e-6", "world-1e6"}) {
        const Image other = image_of(Scene(extreme_scene(name), 1), kMis, {48, 48, 4});
        EXPECT_LT(test::part_that_differs(image, other), 0.01) << name;
        EXPECT_NEAR(mean_of(other) / mean_of(image), 1, 1e-3) << name;
    }
}

// Against the same rounded corners at the origin. Points are rounded to 1/128 units there and the
// room is 2 units wide: everything must be where it was, the whole within a hundredth and every
// part of the image within a tenth.
TEST(Translation, FarFromTheOriginTheImageIsTheSame) {
    const SceneDescription there = extreme_scene("far-from-origin");
    const SceneDescription here = translated(there, {-1e5F, 1e5F, -1e5F});
    for (const ParameterMap& parameters : {kNee, kMis}) {
        const Image far = image_of(Scene(there, 1), parameters, {96, 96, 16});
        const Image near = image_of(Scene(here, 1), parameters, {96, 96, 16});
        EXPECT_NEAR(mean_of(far) / mean_of(near), 1, 0.01);
        EXPECT_LT(test::worst_block(far, near), 0.1);
    }
}

// No closed form: finding lights by BSDF sampling and by next event estimation must agree.
TEST(Room, IsTheSameByBothTechniquesAtEveryScale) {
    for (const char* name : {"world-1e-6", "world-1e6"}) {
        const Scene scene(extreme_scene(name), 1);
        const std::vector<double> by_bsdf = means(scene, kBsdf, {16, 16, 16});
        const std::vector<double> by_lights = means(scene, kNee, {16, 16, 16});
        std::vector<double> differences;
        for (std::size_t i = 0; i < by_bsdf.size(); ++i) {
            differences.push_back(1 + by_bsdf[i] - by_lights[i]);
        }
        EXPECT_GT(test::p_value_of_mean(differences, 1), kLevel) << name;
    }
}

}  // namespace
}  // namespace misbench
