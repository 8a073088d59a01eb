// The optimal weights' linear system and estimators on numbers that are known.
#include "renderer/mis/optimal_weights.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>
#include <random>

namespace misbench {
namespace {

using testing::Each;
using testing::Pointwise;

MATCHER(IsNear, "") { return std::abs(std::get<0>(arg) - std::get<1>(arg)) < 1e-9; }

// Iterations of one uniform sample and two of density 2x, of f.
template <typename Estimator, typename Function>
double run(const Function& f, int iterations, unsigned seed) {
    std::mt19937_64 rng(seed);
    std::uniform_real_distribution<double> u(0, 1);
    Estimator estimator({1, 2});
    for (int i = 0; i < iterations; ++i) {
        for (const double x : {u(rng), std::sqrt(u(rng)), std::sqrt(u(rng))}) {
            estimator.add(std::array{1.0, 4 * x}, f(x));
        }
        estimator.end_iteration();
    }
    return estimator.estimate();
}

double sum_of_densities(double x) { return 3 - x; }  // 3 p_1 - p_2 / 2, of integral 2.5

TEST(OptimalWeights, SolveARegularSystem) {
    // [2 1; 1 3] α = [3; 4]
    EXPECT_THAT(solve_for_optimal(std::array{2.0, 1.0, 3.0}, std::array{3.0, 4.0}),
                Pointwise(IsNear(), std::array{1.0, 1.0}));
}

TEST(OptimalWeights, TakeTheLeastOfManySolutions) {
    // Two equal densities, and a technique that was never hit.
    EXPECT_THAT(
        solve_for_optimal(std::array{1.0, 1.0, 1.0, 0.0, 0.0, 0.0}, std::array{2.0, 2.0, 0.0}),
        Pointwise(IsNear(), std::array{1.0, 1.0, 0.0}));
}

TEST(OptimalWeights, AreThoseOfTheBalanceHeuristicWhenAllIsZero) {
    EXPECT_THAT(solve_for_optimal(std::array{0.0, 0.0, 0.0}, std::array{0.0, 0.0}), Each(0));
    EXPECT_EQ(run<DirectEstimator>([](double) { return 0.0; }, 5, 1), 0);
    EXPECT_EQ(run<ProgressiveEstimator>([](double) { return 0.0; }, 5, 1), 0);
    std::array<double, 2> weighted{};
    weigh_optimally(std::array{1.0, 3.0}, 2, std::array{0.0, 0.0}, weighted);
    EXPECT_THAT(weighted, Pointwise(IsNear(), std::array{0.5, 1.5}));
}

TEST(OptimalWeights, SumToOneTimesTheIntegrand) {
    std::array<double, 3> weighted{};
    weigh_optimally(std::array{1.0, 3.0, 0.5}, -2, std::array{0.7, -4.0, 11.0}, weighted);
    EXPECT_NEAR(std::accumulate(weighted.begin(), weighted.end(), 0.0), -2, 1e-12);
}

TEST(OptimalWeights, FewerSamplesThanTechniquesAreWeighedByBalance) {
    DirectEstimator direct({1, 1, 1});
    direct.add(std::array{1.0, 2.0, 1.0}, 8);
    direct.add(std::array{1.0, 0.0, 1.0}, 3);
    direct.end_iteration();
    EXPECT_NEAR(direct.estimate(), 3.5, 1e-12);
}

TEST(OptimalWeights, MakeASumOfDensitiesExact) {
    EXPECT_NEAR(run<DirectEstimator>(sum_of_densities, 4, 1), 2.5, 1e-9);
    // Of the progressive estimator all iterations but two are exact: then it has four samples.
    const double first = run<ProgressiveEstimator>(sum_of_densities, 2, 1);
    EXPECT_NEAR(run<ProgressiveEstimator>(sum_of_densities, 10, 1), (2 * first + 8 * 2.5) / 10,
                1e-9);
}

TEST(OptimalWeights, OfEqualTechniquesAreFinite) {
    DirectEstimator direct({1, 1});
    ProgressiveEstimator progressive({1, 1});
    for (int i = 0; i < 10; ++i) {
        for (const double f : {1.0, 3.0}) {
            direct.add(std::array{1.0, 1.0}, f);
            progressive.add(std::array{1.0, 1.0}, f);
        }
        direct.end_iteration();
        progressive.end_iteration();
    }
    EXPECT_NEAR(direct.estimate(), 2, 1e-9);
    EXPECT_NEAR(progressive.estimate(), 2, 1e-9);
}

}  // namespace
}  // namespace misbench
