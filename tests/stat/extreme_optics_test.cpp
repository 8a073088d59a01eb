// Extreme scenes of glass, mirrors and an environment map, against their right answers.
#include <gtest/gtest.h>

#include "renderer/scene/camera.h"
#include "renderer/scene/scene.h"
#include "tests/support/extremes.h"
#include "tests/support/statistics.h"

namespace misbench {
namespace {

using test::extreme_scene;
using test::mean_of;

constexpr double kAlpha = 0.01;
constexpr int kComparisons = 4;
constexpr int kSeeds = 24;

Image image_of(const Scene& scene, const ParameterMap& parameters, int size, int samples,
               std::int64_t seed = 1) {
    return test::image_by("path", scene, parameters, {size, size, samples}, seed);
}

// What the walls emit goes through the block unchanged: at every boundary one of reflection and
// refraction is chosen, and the radiance that a denser medium gains it loses on the way out.
TEST(GlassOfAlmostAir, IsNotSeen) {
    const Scene scene(extreme_scene("almost-air"), 1);
    const std::int64_t depth = 200;
    for (const bool nee : {false, true}) {
        const Image image =
            image_of(scene, {{"max_depth", depth}, {"rr_depth", depth}, {"nee", nee}}, 64, 4);
        for (const float value : image.rgb) ASSERT_NEAR(value, 1, 1e-4F) << nee;
    }
}

// The number of mirrors that a ray from the corridor's middle meets before the wall at its end, by
// unfolding the corridor: one for every half a width and then every width that it goes sideways.
double corridor_radiance(double sideways_over_forward) {
    const double half_width = double{extremes::kCorridorHalfWidth};
    const double sideways = double{extremes::kCorridorLength} * std::abs(sideways_over_forward);
    const double n_mirrors = std::floor((sideways + half_width) / (2 * half_width));
    return std::pow(double{extremes::kMirrorReflectance}, n_mirrors);
}

TEST(MirrorCorridor, GetsDarkerByOneFactorAMirror) {
    const SceneDescription description = extreme_scene("mirror-corridor");
    const double tan_half_fov = std::tan(double{description.camera.fov_degrees} * M_PI / 360);
    constexpr int kSteps = 1'000'000;
    double expected = 0;
    for (int i = 0; i < kSteps; ++i) {
        expected += corridor_radiance(((i + 0.5) / kSteps * 2 - 1) * tan_half_fov) / kSteps;
    }
    const std::int64_t depth = 100;
    const Scene scene(description, 1);
    for (const bool nee : {false, true}) {
        std::vector<double> values;
        for (int seed = 0; seed < kSeeds; ++seed) {
            values.push_back(
                mean_of(image_of(scene, {{"max_depth", depth}, {"rr_depth", depth}, {"nee", nee}},
                                 32, 4, 100 + seed)));
        }
        EXPECT_GT(test::p_value_of_mean(values, expected), test::sidak(kAlpha, kComparisons))
            << nee;
    }
}

// ∫ cosθ dω over the cells of the map's upper half, floor facing +y: Δφ (sin²θ₂ - sin²θ₁) / 2.
double hot_map_irradiance() {
    const double d_phi = 2 * M_PI / extremes::kHotMapWidth;
    double irradiance = M_PI;  // of the radiance 1 from everywhere
    const double theta1 = M_PI * extremes::kHotRow / extremes::kHotMapHeight;
    const double theta2 = M_PI * (extremes::kHotRow + 1) / extremes::kHotMapHeight;
    const double sin2 = std::pow(std::sin(theta2), 2) - std::pow(std::sin(theta1), 2);
    irradiance += (double{extremes::kHotRadiance} - 1) * d_phi * sin2 / 2;
    return irradiance;
}

// BSDF sampling alone is left out: it finds the texel once in hundreds of samples.
TEST(HotTexel, IlluminatesTheFloorByNextEventEstimationAndTogether) {
    const Scene scene(extreme_scene("hot-texel"), 1);
    const double expected = double{extremes::kFloorAlbedo} / M_PI * hot_map_irradiance();
    for (const ParameterMap& parameters : {ParameterMap{{"bsdf", false}}, ParameterMap{}}) {
        std::vector<double> values;
        for (int seed = 0; seed < kSeeds; ++seed) {
            values.push_back(mean_of(image_of(scene, parameters, 16, 16, 100 + seed)));
        }
        EXPECT_GT(test::p_value_of_mean(values, expected), test::sidak(kAlpha, kComparisons));
    }
}

}  // namespace
}  // namespace misbench
