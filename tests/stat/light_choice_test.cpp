// Lights are chosen as often as their probability says.
#include <gtest/gtest.h>

#include "renderer/scene/light_sampler.h"
#include "tests/support/lights.h"
#include "tests/support/statistics.h"

namespace misbench {
namespace {

// One false alarm among all comparisons of this binary with this probability.
constexpr double kAlpha = 0.01;
constexpr std::uint32_t kPoints = 8;
const int kComparisons = static_cast<int>(light_selections().size() * kPoints) + 2;

// Of the numbers of choices that fall to each group of lights, light % n_groups.
double p_value_of_choices(const LightSampler& sampler, std::size_t n_lights, std::size_t n_groups,
                          Vec3 from, std::uint32_t seed) {
    constexpr std::uint32_t kChoices = 100'000;
    std::vector<double> expected(n_groups);
    for (std::uint32_t i = 0; i < n_lights; ++i) {
        expected[i % n_groups] += kChoices * sampler.probability(i, from);
    }
    std::vector<double> observed(n_groups);
    for (std::uint32_t i = 0; i < kChoices; ++i) {
        Rng rng(seed, i, 0);
        double u = double{rng.uniform()};
        u += 0x1p-24 * double{rng.uniform()};
        observed[sampler.select(from, u)->light % n_groups] += 1;
    }
    return test::p_value_of_counts(observed, expected);
}

TEST(LightSelection, ChoosesLightsAsOftenAsItSays) {
    std::vector<LightBounds> lights = test::random_lights(200, 1, 41);
    lights[7].is_infinite = true;
    lights[123].is_infinite = true;
    for (const LightSelection& selection : light_selections()) {
        const LightSampler sampler(lights, selection);
        for (std::uint32_t i = 0; i < kPoints; ++i) {
            Rng rng(42, i, 0);
            const Vec3 from = test::random_point(rng, 2);
            EXPECT_GT(p_value_of_choices(sampler, lights.size(), lights.size(), from, 43 + i),
                      test::sidak(kAlpha, kComparisons))
                << selection.name << " " << i;
        }
    }
}

// Most of them are less likely than one in the number of choices.
TEST(LightTree, ChoosesAmongManyLightsAsOftenAsItSays) {
    const std::vector<LightBounds> lights = test::random_lamps(200'000, 1, 44);
    const LightSampler tree(lights, find_light_selection("tree"));
    for (std::uint32_t i = 0; i < 2; ++i) {
        Rng rng(45, i, 0);
        const Vec3 from = test::random_point(rng, 2);
        // Neighbours in space are in different groups: their order is random.
        EXPECT_GT(p_value_of_choices(tree, lights.size(), 1000, from, 46 + i),
                  test::sidak(kAlpha, kComparisons))
            << i;
    }
}

}  // namespace
}  // namespace misbench
