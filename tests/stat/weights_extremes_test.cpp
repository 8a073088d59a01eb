// Factors change the noise and not the mean, however extreme they are. The one rule that does is
// measured.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "renderer/methods/render_loop.h"
#include "tests/support/scenes.h"
#include "tests/support/statistics.h"

namespace misbench {
namespace {

// One false alarm among all comparisons of this binary with this probability.
constexpr double kAlpha = 0.01;
constexpr int kComparisons = 20;  // at the most

std::int64_t n(std::int64_t value) { return value; }
std::string text(const char* value) { return value; }

SceneDescription lit_box() {
    SceneDescription scene = test::open_box();
    scene.meshes.push_back(test::ceiling_lamp());
    return scene;
}

// Of all pixels and channels, by seed.
std::vector<double> means(const Scene& scene, const std::string& method, ParameterMap parameters,
                          std::int64_t n_passes, int n_seeds, std::int64_t first_seed) {
    parameters.insert({"max_depth", n(4)});
    parameters.insert({"min_depth", n(2)});
    std::vector<double> means;
    for (int i = 0; i < n_seeds; ++i) {
        const RenderResult result = render(scene, {.method = method,
                                                   .parameters = parameters,
                                                   .width = 12,
                                                   .height = 9,
                                                   .budget = SampleBudget{n_passes},
                                                   .seed = first_seed + i});
        EXPECT_TRUE(result.valid);
        double sum = 0;
        for (const float value : result.image.rgb) sum += double{value};
        means.push_back(sum / static_cast<double>(result.image.rgb.size()));
    }
    return means;
}

double mean_of(const std::vector<double>& values) {
    double sum = 0;
    for (const double v : values) sum += v;
    return sum / static_cast<double>(values.size());
}

TEST(ExtremeFactors, DoNotChangeTheMean) {
    const Scene scene(lit_box(), 1);
    const std::vector<ParameterMap> all = {
        {{"factors", text("correction")},
         {"correction_groups", text("light+nee+hit")},
         {"correction_candidates", text("1e-30")}},
        {{"factors", text("correction")},
         {"correction_groups", text("nee+light")},
         {"correction_candidates", text("1e-30,1e30")},
         {"correction_filter", text("none")}},
        {{"factors", text("correction")},
         {"correction_groups", text("hit+light")},
         {"correction_candidates", text("1e-4,1e4")},
         {"correction_filter", text("bilateral")},
         {"correction_keep", false}},
        {{"factors", text("correlation")},
         {"shadow_rays", n(3)},
         {"correlation_scale", 1e-6},
         {"correlation_bounded", false}},
        {{"factors", text("variance")}, {"variance_tile", n(1)}, {"variance_keep", 1e30}},
        {{"factors", text("variance")},
         {"variance_factor", text("reciprocal")},
         {"variance_tile", n(1)},
         {"variance_keep", 1e30}},
        {{"factors", text("variance")}, {"variance_update", true}},
        {{"factors", text("variance+variance+correction")}, {"variance_blur", n(1)}},
    };
    constexpr int kSeeds = 100;
    const std::vector<double> plain = means(scene, "bdpt", {}, 8, kSeeds, 500);
    for (std::size_t i = 0; i < all.size(); ++i) {
        const std::vector<double> with = means(scene, "bdpt", all[i], 4, kSeeds, 10'000);
        std::vector<double> differences;
        for (std::size_t s = 0; s < kSeeds; ++s) differences.push_back(with[s] - plain[s]);
        EXPECT_GT(test::p_value_of_mean(differences, 0), test::sidak(kAlpha, kComparisons))
            << "row " << i << ": " << mean_of(with) << " instead of " << mean_of(plain);
    }
}

// Tiles that forget the pass of training are chosen by what was found in it, so that what stays is
// no fair sample: the bias that Kirk and Arvo described. It is largest where few passes follow.
TEST(KeptTiles, HaveASmallBias) {
    const Scene scene(lit_box(), 1);
    constexpr int kSeeds = 1200;
    const std::vector<double> plain = means(scene, "bdpt", {}, 8, kSeeds / 2, 500);
    const double expected = mean_of(plain);
    const double level = test::sidak(kAlpha, kComparisons);
    struct Row {
        int tile;
        double keep;
        int n_passes;
        double largest_bias;  // relative
    };
    for (const auto& [tile, keep, n_passes, largest_bias] :
         {Row{2, 1e30, 2, 0}, Row{2, 2, 2, 0.02}, Row{2, 2, 8, 0.005}, Row{8, 2, 2, 0.005}}) {
        const std::vector<double> with = means(
            scene, "bdpt",
            {{"factors", text("variance")}, {"variance_keep", keep}, {"variance_tile", n(tile)}},
            n_passes, kSeeds / n_passes, 20'000);
        const double bias = mean_of(with) / expected - 1;
        const double p_value = test::p_value_of_mean(with, expected);
        std::cout << "tiles of " << tile << ", kept up to " << keep << ", " << n_passes
                  << " passes: bias " << 100 * bias << " %, p " << p_value << '\n';
        if (largest_bias == 0) {
            EXPECT_GT(p_value, level) << "nothing is forgotten";
        } else {
            EXPECT_LT(std::abs(bias), largest_bias) << tile << ' ' << n_passes;
        }
        if (largest_bias == 0.02) {
            EXPECT_LT(p_value, level) << "no bias would be seen";
        }
    }
}

}  // namespace
}  // namespace misbench
