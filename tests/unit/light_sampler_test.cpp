#include "renderer/scene/light_sampler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <numbers>

#include "renderer/base/error.h"
#include "tests/support/lights.h"

namespace misbench {
namespace {

LightSampler sampler(std::span<const LightBounds> lights, const std::string& selection) {
    return {lights, find_light_selection(selection)};
}

LightBounds lamp(double power, Vec3 at, Vec3 axis) {
    return {.power = power, .lower = at, .upper = at, .axis = axis, .cos_normals = 1};
}

LightBounds sky(double power) {
    LightBounds light;
    light.power = power;
    light.is_infinite = true;
    return light;
}

double sum_of_probabilities(const LightSampler& sampler, std::size_t n_lights, Vec3 from) {
    double sum = 0;
    for (std::uint32_t i = 0; i < n_lights; ++i) sum += sampler.probability(i, from);
    return sum;
}

// What must hold of any lights seen from any point.
void expect_consistent(std::span<const LightBounds> lights, Vec3 from) {
    for (const LightSelection& selection : light_selections()) {
        const LightSampler sampler(lights, selection);
        const double sum = sum_of_probabilities(sampler, lights.size(), from);
        for (const double u : {0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 1 - 0x1p-53}) {
            const auto choice = sampler.select(from, u);
            EXPECT_NEAR(sum, choice ? 1 : 0, 1e-12) << selection.name;
            if (!choice) continue;
            EXPECT_GT(choice->probability, 0) << selection.name;
            EXPECT_EQ(choice->probability, sampler.probability(choice->light, from))
                << selection.name;
        }
    }
}

TEST(LightSelection, IsFoundByItsNameOrRefused) {
    for (const LightSelection& row : light_selections()) {
        EXPECT_EQ(&find_light_selection(std::string(row.name)), &row);
    }
    EXPECT_THROW(find_light_selection("bright"), ParameterError);
}

TEST(LightSampler, GivesEveryLightItsFixedProbability) {
    const std::vector<LightBounds> lights = {lamp(1, {}, {0, 1, 0}), lamp(3, {}, {0, 1, 0}),
                                             lamp(4, {}, {0, 1, 0})};
    const LightSampler uniform = sampler(lights, "uniform");
    const LightSampler power = sampler(lights, "power");
    EXPECT_DOUBLE_EQ(uniform.probability(2, {}), 1.0 / 3);
    EXPECT_EQ(power.probability(0, {}), 0.125);
    EXPECT_EQ(power.probability(2, {}), 0.5);
    std::array<int, 3> counts{};
    for (int i = 0; i < 8000; ++i) ++counts[power.select({}, (i + 0.5) / 8000)->light];
    EXPECT_THAT(counts, testing::ElementsAre(1000, 3000, 4000));
    EXPECT_EQ(power.select({}, 1 - 0x1p-53)->light, 2U);
}

TEST(LightSampler, ChoosesSurfacesByTheirAreaAndOtherLightsAsAllOfThem) {
    std::vector<LightBounds> lights = {sky(1), lamp(9, {}, {0, 1, 0}), sky(7),
                                       lamp(2, {0, 1, 0}, {0, 1, 0})};
    lights[1].area = 0.5;
    lights[3].area = 1.5;
    const LightSampler all = sampler(lights, "area");
    EXPECT_DOUBLE_EQ(all.probability(0, {}), 1.0 / 3);
    EXPECT_DOUBLE_EQ(all.probability(1, {}), 0.25 / 3);
    EXPECT_DOUBLE_EQ(all.probability(2, {}), 1.0 / 3);
    EXPECT_DOUBLE_EQ(all.probability(3, {}), 0.75 / 3);
    EXPECT_EQ(sampler(std::vector{lights[1], lights[3]}, "area").probability(1, {}), 0.75);
    EXPECT_EQ(sampler(std::vector{lights[0], lights[2]}, "area").probability(1, {}), 0.5);
}

TEST(LightSampler, OfNoLightsHasNoChoice) {
    for (const LightSelection& selection : light_selections()) {
        EXPECT_FALSE(LightSampler({}, selection).select({}, 0.5)) << selection.name;
    }
}

TEST(LightSampler, ChoosesALightWithoutPowerOnlyIfAllAreAlike) {
    const std::vector<LightBounds> lights = {lamp(0, {1, 1, 1}, {0, 1, 0}),
                                             lamp(2, {0, 1, 0}, {0, -1, 0}), sky(0)};
    EXPECT_NEAR(sampler(lights, "uniform").probability(0, {}), 1.0 / 3, 1e-15);
    for (const char* name : {"power", "tree"}) {
        const LightSampler chosen = sampler(lights, name);
        EXPECT_EQ(chosen.probability(0, {}), 0) << name;
        EXPECT_EQ(chosen.probability(1, {}), 1) << name;
        EXPECT_EQ(chosen.probability(2, {}), 0) << name;
        for (const double u : {0.0, 0.5, 1 - 0x1p-53}) EXPECT_EQ(chosen.select({}, u)->light, 1U);
        const std::vector<LightBounds> dark = {lights[0], lights[2]};
        EXPECT_FALSE(sampler(dark, name).select({}, 0.5)) << name;
        EXPECT_EQ(sampler(dark, name).probability(0, {}), 0) << name;
    }
}

// A candle beside the sun: with 24 bits no value of u would choose it.
TEST(LightSampler, AsksForAFinerNumberWhereALightIsFaint) {
    EXPECT_FALSE(sampler(std::vector{sky(1), sky(1000)}, "power").needs_fine_u());
    const std::vector<LightBounds> lights = {sky(1e9), sky(1), sky(1e9)};
    EXPECT_TRUE(sampler(lights, "power").needs_fine_u());
    EXPECT_FALSE(sampler(lights, "uniform").needs_fine_u());
    EXPECT_TRUE(sampler(lights, "tree").needs_fine_u());
    EXPECT_EQ(sampler(lights, "power").select({}, 0.5)->light, 1U);
}

TEST(LightTree, KnowsTheSidesOfASingleLight) {
    const std::vector<LightBounds> lights = {lamp(3, {0, 1, 0}, {0, -1, 0})};
    const LightSampler tree = sampler(lights, "tree");
    EXPECT_EQ(tree.select({0, 0, 0}, 0.5)->probability, 1);
    EXPECT_EQ(tree.select({5, 0.5F, 0}, 0.5)->probability, 1);
    EXPECT_EQ(tree.select({0, 1, 0}, 0.5)->probability, 1);  // where it is
    EXPECT_FALSE(tree.select({0, 2, 0}, 0.5));
    EXPECT_FALSE(tree.select({5, 1.1F, 0}, 0.5));
    EXPECT_EQ(tree.probability(0, {0, 2, 0}), 0);
}

TEST(LightTree, WeighsByPowerAndDistance) {
    const std::vector<LightBounds> lights = {lamp(3, {0, 2, 0}, {0, -1, 0}),
                                             lamp(1, {0, 1, 0}, {0, -1, 0})};
    const LightSampler tree = sampler(lights, "tree");
    EXPECT_NEAR(tree.probability(0, {}), 0.75 / 1.75, 1e-6);
}

TEST(LightTree, ChoosesAmongInfiniteLightsAndTheHierarchyAlike) {
    const std::vector<LightBounds> lights = {sky(1), lamp(3, {0, 1, 0}, {0, -1, 0}), sky(5),
                                             lamp(3, {0, 1, 0}, {0, -1, 0})};
    const LightSampler tree = sampler(lights, "tree");
    EXPECT_DOUBLE_EQ(tree.probability(0, {}), 1.0 / 3);
    EXPECT_DOUBLE_EQ(tree.probability(1, {}), 1.0 / 6);
    EXPECT_DOUBLE_EQ(tree.probability(0, {0, 2, 0}), 1.0 / 2);  // behind both lamps
    for (const Vec3 from : {Vec3{}, Vec3{0, 2, 0}}) expect_consistent(lights, from);
    expect_consistent(std::vector{sky(1), sky(2)}, {});
}

TEST(LightSampler, ProbabilitiesSumToOneOverRandomLights) {
    for (const int n : {1, 2, 3, 5, 30, 1000}) {
        const auto seed = static_cast<std::uint32_t>(n);
        std::vector<LightBounds> lights = test::random_lights(n, 1, seed);
        if (n == 5) lights.push_back(sky(1));
        for (std::uint32_t i = 0; i < 20; ++i) {
            Rng rng(31, i, seed);
            expect_consistent(lights, test::random_point(rng, i < 10 ? 1.0F : 3.0F));
        }
    }
}

TEST(LightSampler, ManagesDegenerateLights) {
    const LightBounds up = lamp(1, {1, 2, 3}, {0, 1, 0});
    const LightBounds down = lamp(1e-12, {1, 2, 3}, {0, -1, 0});
    std::vector<LightBounds> at_one_point;
    std::vector<LightBounds> at_the_origin;
    std::vector<LightBounds> in_one_box;
    std::vector<LightBounds> ever_closer;  // each slice takes off few of them
    for (int i = 0; i < 230; ++i) {
        at_one_point.push_back(i % 3 == 0 ? up : down);
        at_the_origin.push_back(lamp(1, {}, {0, 1, 0}));
        in_one_box.push_back(up);
        in_one_box.back().upper = {4, 4, 4};
        ever_closer.push_back(lamp(1, {std::ldexp(1.0F, i - 115), 0, 0}, {0, 1, 0}));
    }
    for (const auto& lights : {at_one_point, at_the_origin, in_one_box, ever_closer}) {
        for (const Vec3 from : {Vec3{1, 2, 3}, Vec3{2, 3, 4}, Vec3{}, Vec3{0, 9, 0}, Vec3{0, -9, 0},
                                Vec3{1e6F, 1e6F, 1e6F}, Vec3{1e-30F, 1e-30F, 0}}) {
            expect_consistent(lights, from);
        }
    }
}

TEST(LightTree, IsTheSameInAScaledWorld) {
    const std::vector<LightBounds> lights = test::random_lights(300, 1, 5);
    for (const float scale : {1e-6F, 1e6F}) {
        std::vector<LightBounds> scaled = lights;
        for (LightBounds& light : scaled) {
            light.lower = scale * light.lower;
            light.upper = scale * light.upper;
        }
        const LightSampler tree = sampler(lights, "tree");
        const LightSampler scaled_tree = sampler(scaled, "tree");
        for (std::uint32_t i = 0; i < 20; ++i) {
            Rng rng(32, i, 0);
            const Vec3 from = test::random_point(rng, 2);
            for (std::uint32_t k = 0; k < lights.size(); ++k) {
                const double p = tree.probability(k, from);
                EXPECT_NEAR(scaled_tree.probability(k, scale * from), p, 1e-3 * p + 1e-6);
            }
        }
    }
}

// A direction at `angle` from the axis, anywhere around it.
Vec3 tilted(Vec3 axis, double angle, Rng& rng) {
    const Frame frame = Frame::from_z(axis);
    const float phi = 2 * kPi * rng.uniform();
    const auto sin = static_cast<float>(std::sin(angle));
    return frame.to_world(
        {sin * std::cos(phi), sin * std::sin(phi), static_cast<float>(std::cos(angle))});
}

// Points that a light just reaches: from a point of its box, about a normal at the rim of its
// cone, at the rim of its emission.
TEST(LightTree, GivesAChanceToEveryLightThatReachesThePoint) {
    for (const float half_width : {1e-6F, 1.0F, 1e6F}) {
        const std::vector<LightBounds> lights = test::random_lights(100, half_width, 6);
        const LightSampler tree = sampler(lights, "tree");
        for (std::uint32_t i = 0; i < 100'000; ++i) {
            Rng rng(33, i, 0);
            const auto k = static_cast<std::uint32_t>(100 * rng.uniform());
            const LightBounds& light = lights[k];
            const auto rim = [&rng] { return rng.uniform() < 0.5F ? 1.0 : double{rng.uniform()}; };
            const double from_axis = rim() * std::acos(double{light.cos_normals});
            const double from_normal = rim() * std::acos(double{light.cos_emission});
            // The normal either between the axis and the direction, or anywhere around the axis.
            Vec3 direction;
            if (rng.uniform() < 0.5F) {
                const double angle = std::min(std::numbers::pi, from_axis + from_normal);
                direction = tilted(light.axis, angle, rng);
            } else {
                direction = tilted(tilted(light.axis, from_axis, rng), from_normal, rng);
            }
            const auto within = [&](float lo, float hi) {
                const float t = std::round(3 * rng.uniform()) / 3;
                return (1 - t) * lo + t * hi;
            };
            const Vec3 point = {within(light.lower.x, light.upper.x),
                                within(light.lower.y, light.upper.y),
                                within(light.lower.z, light.upper.z)};
            const float distance = half_width * std::pow(10.0F, 8 * rng.uniform() - 2);
            ASSERT_GT(tree.probability(k, point + distance * direction), 0)
                << half_width << ' ' << i;
        }
    }
}

// The relative variance of the irradiance from small lamps, chosen one at a time.
double variance(std::span<const LightBounds> lights, const LightSampler& sampler, Vec3 from) {
    double irradiance = 0;
    double second_moment = 0;
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        const Vec3 edge = 0.5F * (lights[i].lower + lights[i].upper) - from;
        const double d2 = double{dot(edge, edge)};
        const double cosines = double{std::max(0.0F, edge.y)} *
                               double{std::max(0.0F, -dot(lights[i].axis, edge))} / d2;
        if (cosines == 0) continue;
        const double contribution = lights[i].power * cosines / d2;
        irradiance += contribution;
        second_moment += contribution * contribution / sampler.probability(i, from);
    }
    return second_moment / (irradiance * irradiance) - 1;
}

// By 5.4 here.
TEST(LightTree, LowersTheVarianceOfAThousandLampsByAFactorOfThree) {
    const std::vector<LightBounds> lights = test::random_lamps(1000, 5, 7);
    const LightSampler power = sampler(lights, "power");
    const LightSampler tree = sampler(lights, "tree");
    double by_power = 0;
    double by_tree = 0;
    for (std::uint32_t i = 0; i < 200; ++i) {
        Rng rng(34, i, 0);
        const Vec3 from = test::random_point(rng, 5);
        if (from.y > 3) continue;  // hardly a lamp above
        by_power += variance(lights, power, from);
        by_tree += variance(lights, tree, from);
    }
    EXPECT_GT(by_power / by_tree, 3);
}

}  // namespace
}  // namespace misbench
