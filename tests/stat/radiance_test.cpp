// Scenes whose radiance is known: every estimator must agree within its own standard error.
#include <gtest/gtest.h>

#include "renderer/methods/next_event.h"
#include "renderer/methods/render_loop.h"
#include "renderer/mis/heuristics.h"
#include "tests/support/scenes.h"
#include "tests/support/statistics.h"

namespace misbench {
namespace {

// One false alarm among all comparisons of this binary with this probability.
constexpr double kAlpha = 0.01;
constexpr int kSeeds = 24;

struct Estimator {
    std::string name;
    std::string method;
    ParameterMap parameters;
};

// Every way to estimate direct light: techniques alone, and together with every heuristic.
std::vector<Estimator> estimators() {
    const std::int64_t depth = 64;
    std::vector<Estimator> all = {
        {"bsdf", "path", {{"nee", false}, {"max_depth", depth}}},
        {"nee", "path", {{"bsdf", false}, {"max_depth", depth}}},
        {"nee_uniform",
         "path",
         {{"bsdf", false}, {"max_depth", depth}, {"light_selection", std::string("uniform")}}},
        {"direct_1_3",
         "direct",
         {{"light_samples", std::int64_t{1}}, {"bsdf_samples", std::int64_t{3}}}},
        {"direct_2_0",
         "direct",
         {{"light_samples", std::int64_t{2}}, {"bsdf_samples", std::int64_t{0}}}},
        {"direct_0_1",
         "direct",
         {{"light_samples", std::int64_t{0}}, {"bsdf_samples", std::int64_t{1}}}},
    };
    for (const MisHeuristic& row : heuristics()) {
        const std::string mis(row.name);
        all.push_back({"path_" + mis, "path", {{"mis", mis}, {"max_depth", depth}}});
        all.push_back({"direct_" + mis,
                       "direct",
                       {{"mis", mis},
                        {"light_samples", std::int64_t{3}},
                        {"bsdf_samples", std::int64_t{2}}}});
    }
    return all;
}

// The image's mean of one channel for each of kSeeds seeds.
std::vector<double> means(const Scene& scene, const Estimator& estimator, int size, int samples) {
    std::vector<double> values;
    for (int seed = 0; seed < kSeeds; ++seed) {
        const RenderResult result = render(scene, {.method = estimator.method,
                                                   .parameters = estimator.parameters,
                                                   .width = size,
                                                   .height = size,
                                                   .budget = SampleBudget{samples},
                                                   .seed = 100 + seed,
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

class EveryEstimator : public testing::TestWithParam<std::size_t> {
 protected:
    // Two scenes, each with all estimators.
    static double level() { return test::sidak(kAlpha, 2 * static_cast<int>(estimators().size())); }
    const Estimator estimator_ = estimators()[GetParam()];
};

// The irradiance of a Lambert lamp on a parallel element below its corner, over π L: the form
// factor of a rectangle with sides a, b at distance 1 (by integration of cos⁴θ / π over it).
double corner_form_factor(double a, double b) {
    const double ra = std::sqrt(1 + a * a);
    const double rb = std::sqrt(1 + b * b);
    return (a / ra * std::atan(b / ra) + b / rb * std::atan(a / rb)) / (2 * M_PI);
}

TEST_P(EveryEstimator, FindsTheLightOfALampOverAFloor) {
    const Scene scene(test::floor_under_lamp({0.8F, 0.8F, 0.8F}, {5, 5, 5}), 1);
    const double form_factor =
        4 * corner_form_factor(double{test::kLampHalfWidth} / double{test::kLampHeight},
                               double{test::kLampHalfDepth} / double{test::kLampHeight});
    const double expected = double{0.8F} * 5 * form_factor;
    EXPECT_GT(test::p_value_of_mean(means(scene, estimator_, 16, 16), expected), level())
        << estimator_.name;
}

TEST_P(EveryEstimator, FindsNoLightBehindALamp) {
    const Scene scene(test::floor_under_lamp({0.8F, 0.8F, 0.8F}, {5, 5, 5}, /*turned=*/true), 1);
    for (const double mean : means(scene, estimator_, 4, 4)) EXPECT_EQ(mean, 0);
}

// In a closed room whose walls emit 1 and reflect ρ, radiance is Σ ρ^k: 1 / (1 - ρ) for paths of
// any length, 1 + ρ for direct light. (Next event estimation alone is left out: near the corners
// its variance is infinite, so that no standard error is to be had.)
TEST_P(EveryEstimator, FindsTheLightOfAFurnace) {
    const bool has_bsdf_hits =
        estimator_.name.find("nee") == std::string::npos && estimator_.name != "direct_2_0";
    if (!has_bsdf_hits) return;
    const float rho = 0.6F;
    const Scene scene(test::furnace(DiffuseMaterial{{rho, rho, rho}}, {1, 1, 1}), 1);
    const double expected = estimator_.method == "direct" ? 1 + double{rho} : 1 / (1 - double{rho});
    EXPECT_GT(test::p_value_of_mean(means(scene, estimator_, 16, 8), expected), level())
        << estimator_.name;
}

INSTANTIATE_TEST_SUITE_P(Table, EveryEstimator, testing::Range(std::size_t{0}, estimators().size()),
                         [](const auto& test) {
                             std::string name = estimators()[test.param].name;
                             for (char& c : name) c = c == '.' ? '_' : c;
                             return name;
                         });

// The mean of 1/p over samples of density p is the size of the domain: the lamp's solid angle.
TEST(NextEvent, HasTheDensityThatItSays) {
    const Scene scene(test::floor_under_lamp({}, {5, 5, 5}), 1);
    const auto point = scene.closest({{0, 1, 0}, {0, -1, 0}});
    ASSERT_TRUE(point);
    const double a = double{test::kLampHalfWidth};
    const double b = double{test::kLampHalfDepth};
    const double h = double{test::kLampHeight};
    const double expected = 4 * std::atan(a * b / (h * std::sqrt(a * a + b * b + h * h)));
    for (const LightSelection& selection : light_selections()) {
        const NextEvent next_event(scene, selection);
        std::vector<double> inverses;
        for (std::uint32_t i = 0; i < 20'000; ++i) {
            Rng rng(21, i, 0);
            const auto sample = next_event.sample(*point, rng);
            ASSERT_TRUE(sample);
            ASSERT_EQ(sample->pdf, next_event.pdf(point->position, sample->point));
            inverses.push_back(1 / sample->pdf);
        }
        EXPECT_GT(test::p_value_of_mean(inverses, expected), kAlpha / 2) << selection.name;
    }
}

// Glossy metal has no analytic image, but both techniques must see the same one.
TEST(Techniques, AgreeOnGlossyMetal) {
    SceneDescription description = test::floor_under_lamp({}, {5, 5, 5});
    description.materials[0] = test::surface(GenericMaterial(
        {.base_color = {0.9F, 0.9F, 0.9F}, .roughness = 0.7F, .ior = 1.45F, .metallic = 0.5F}));
    const Scene scene(std::move(description), 1);
    const std::vector<double> by_lights = means(scene, {"nee", "path", {{"bsdf", false}}}, 16, 64);
    const std::vector<double> by_bsdf = means(scene, {"bsdf", "path", {{"nee", false}}}, 16, 64);
    std::vector<double> differences;
    double mean = 0;
    for (int i = 0; i < kSeeds; ++i) {
        const auto s = static_cast<std::size_t>(i);
        differences.push_back(1 + by_lights[s] - by_bsdf[s]);
        mean += by_lights[s] / kSeeds;
    }
    EXPECT_GT(mean, 0.01);
    EXPECT_GT(test::p_value_of_mean(differences, 1), kAlpha);
}

}  // namespace
}  // namespace misbench
