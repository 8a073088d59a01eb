// What merging estimates in closed form: light averaged over a disk. So its bias is known for every
// radius, and how it vanishes.
#include <gtest/gtest.h>

#include <functional>

#include "renderer/methods/render_loop.h"
#include "tests/support/scenes.h"
#include "tests/support/statistics.h"

namespace misbench {
namespace {

// One false alarm among all comparisons of this binary with this probability.
constexpr double kAlpha = 0.01;
constexpr int kComparisons = 40;  // at the most
constexpr int kSeeds = 16;

constexpr float kRho = 0.8F;
constexpr double kHeight = 1.5;
constexpr double kIntensity = 3;

// A point light at kHeight above the origin of a floor, and a camera that sees next to nothing but
// the origin.
SceneDescription floor_under_point_light() {
    SceneDescription scene = test::floor_under_lamp({kRho, kRho, kRho}, {});
    scene.meshes.resize(1);
    const auto i = static_cast<float>(kIntensity);
    scene.point_lights = {
        {.position = {0, static_cast<float>(kHeight), 0}, .intensity = {i, i, i}}};
    return scene;
}

// The radiance that leaves the floor at distance r from the origin.
double radiance_at(double r) {
    return double{kRho} / M_PI * kIntensity * kHeight / std::pow(r * r + kHeight * kHeight, 1.5);
}

// ∫ K(r) radiance 2πr dr over a disk, with the kernel's own density K.
double blurred(const std::string& kernel, double radius) {
    constexpr int kSteps = 2000;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double r = radius * (i + 0.5) / kSteps;
        const double x = r / radius;
        const double density =
            (kernel == "constant" ? 1 : 2 * (1 - x * x)) / (M_PI * radius * radius);
        sum += density * radiance_at(r) * 2 * M_PI * r * radius / kSteps;
    }
    return sum;
}

struct Merging {
    std::string method;
    ParameterMap parameters;
    double radius = 0;
    std::string kernel = "epanechnikov";
    double shrink = 1;
};

std::vector<double> means(const Scene& scene, const Merging& merging, std::int64_t samples) {
    ParameterMap parameters = merging.parameters;
    parameters["radius"] = std::string("global");
    parameters["radius_scale"] = merging.radius / double{scene.radius()};
    parameters["radius_shrink"] = merging.shrink;
    parameters["kernel"] = merging.kernel;
    std::vector<double> values;
    for (int seed = 0; seed < kSeeds; ++seed) {
        const RenderResult result = render(scene, {.method = merging.method,
                                                   .parameters = parameters,
                                                   .width = 2,
                                                   .height = 2,
                                                   .budget = SampleBudget{samples},
                                                   .seed = 900 + seed,
                                                   .threads = 2});
        EXPECT_TRUE(result.valid);
        double mean = 0;
        for (std::size_t i = 0; i < result.image.rgb.size(); i += 3) {
            mean += double{result.image.rgb[i]} / static_cast<double>(result.image.n_pixels());
        }
        values.push_back(mean);
    }
    return values;
}

void expect_mean(const Merging& merging, double expected, std::int64_t samples) {
    const Scene scene(floor_under_point_light(), 1);
    const std::vector<double> values = means(scene, merging, samples);
    EXPECT_GT(test::p_value_of_mean(values, expected), test::sidak(kAlpha, kComparisons))
        << merging.method << ' ' << merging.kernel << ' ' << merging.radius << ": " << values[0]
        << " expected " << expected;
}

constexpr double kMany = 3000;  // light paths a pixel

TEST(Merging, AveragesLightOverTheKernel) {
    for (const std::string kernel : {"constant", "epanechnikov"}) {
        for (const double radius : {0.2, 0.6, 1.8}) {
            const Merging photon = {.method = "photon",
                                    .parameters = {{"light_paths", kMany}},
                                    .radius = radius,
                                    .kernel = kernel};
            expect_mean(photon, blurred(kernel, radius), 4);
        }
    }
    // The bias that this shows is that of a kernel of second moment R² / 2, R² / 3: quadratic.
    for (const std::string kernel : {"constant", "epanechnikov"}) {
        const double wide = 1 - blurred(kernel, 0.2) / radiance_at(0);
        const double narrow = 1 - blurred(kernel, 0.1) / radiance_at(0);
        EXPECT_NEAR(wide / narrow, 4, 0.1) << kernel;
    }
}

// Merging at the first vertex alone: the same by the other method.
TEST(Merging, IsOneTechniqueOfVertexConnectionAndMerging) {
    const ParameterMap merging_only = {{"hit", false},
                                       {"nee", false},
                                       {"light", false},
                                       {"connect", false},
                                       {"merge_first", true},
                                       {"light_paths", kMany},
                                       {"max_depth", std::int64_t{2}}};
    expect_mean({.method = "vcm", .parameters = merging_only, .radius = 0.6},
                blurred("epanechnikov", 0.6), 4);
}

// r_i = r_1 i^((α-1)/2): the mean over the passes of what each one estimates.
TEST(Merging, ConvergesWithAShrinkingRadius) {
    double previous_bias = 1;
    for (const std::int64_t passes : {1, 8, 64}) {
        constexpr double kShrink = 0.5;
        double expected = 0;
        for (std::int64_t i = 1; i <= passes; ++i) {
            const double radius = 1.8 * std::pow(static_cast<double>(i), (kShrink - 1) / 2);
            expected += blurred("epanechnikov", radius) / static_cast<double>(passes);
        }
        expect_mean({.method = "photon",
                     .parameters = {{"light_paths", 1000.0}},
                     .radius = 1.8,
                     .shrink = kShrink},
                    expected, passes);
        const double bias = 1 - expected / radiance_at(0);
        EXPECT_LT(bias, 0.75 * previous_bias) << passes;
        previous_bias = bias;
    }
}

}  // namespace
}  // namespace misbench
