// What the laboratory computes exactly against what it samples, for every layout and weighting.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "experiments/lab/study_file.h"
#include "tests/support/statistics.h"
#include "tests/support/temporary_folder.h"

namespace misbench::lab {
namespace {

constexpr int kRuns = 20'000;

// Every layout, bias, and zeros of the integrand, without heavy tails: there a sampled variance
// says nothing.
constexpr const char* kFile = R"(name: layouts
weights:
  balance: {heuristic: balance}
  power: {heuristic: power2}
  maximum: {heuristic: maximum}
  cutoff: {heuristic: cutoff0.5}
  constant: {heuristic: constant}
  first-alone: {only: first}
  second-alone: {only: second}
  reciprocal: {heuristic: constant, inverse_variance: exact}
  variance: {heuristic: balance, variance: exact}
  variance-pilot: {heuristic: balance, variance: {pilot: 20}}
  correlation: {heuristic: balance, correlation: popov}
  correction: {heuristic: balance, correction: {candidates: 4}}
  correction-pilot: {heuristic: power, correction: {candidates: 4, moments: {pilot: 20}}}
  all: {heuristic: power1.5, variance: exact, correlation: popov, correction: {candidates: 4, fixed: first}}
  optimal: {optimal: exact}
problems:
  independent:
    integrand: [{shape: gaussian, mean: 0.4, deviation: 0.2}, {shape: linear, from: 0, to: 1}]
    techniques:
      first: {density: {shape: uniform}, samples: 3}
      second: {density: {shape: linear, from: 1, to: 2}, samples: 1}
  stratified:
    integrand: {shape: table, x: [0, 0.4, 0.7, 1], y: [0, 0, 2, 1]}
    techniques:
      first: {density: {shape: linear, from: 1, to: 2}, samples: 2}
      second: {density: {shape: beta, a: 1, b: 1}, samples: 4, layout: stratified}
  shared:
    integrand: [{shape: gaussian, mean: 0.4, deviation: 0.2}, {shape: uniform}]
    techniques:
      first: {density: {shape: uniform}, samples: 2, layout: stratified}
      second: {density: {shape: linear, from: 1, to: 2}, samples: 4, layout: shared, cells: 6}
      third: {density: {shape: linear, from: 2, to: 1}, samples: 1}
  biased:
    domain: [-1, 2]
    integrand: {shape: linear, from: 1, to: 3}
    techniques:
      first: {density: {shape: uniform, support: [-1, 0.5]}, samples: 2, layout: shared, cells: 3}
      second: {density: {shape: uniform, support: [0, 2]}, samples: 2}
)";

Study read(const std::string& text) {
    const TemporaryFolder folder;
    return read_study(folder.write("lab.yaml", text), {});
}

constexpr double kAlpha = 0.01;  // of the whole binary
// Mean and variance of 4 problems and 15 weightings, densities of 4 layouts, 3 estimators' means.
constexpr int kComparisons = 2 * 4 * 15 + 4 + 3;
const double kLevel = test::sidak(kAlpha, kComparisons);

TEST(LabSampling, AgreesWithTheExactMomentsOfEveryLayoutAndWeighting) {
    const Study study = read(kFile);
    ASSERT_EQ(study.cases.size(), 4U);
    for (const Case& one : study.cases) {
        ASSERT_EQ(one.weightings.size(), 15U);
        for (const Weighting& weighting : one.weightings) {
            const std::string what = one.problem.name + " " + weighting.name;
            const auto weights = fix_weights(one.problem, weighting, 1);
            const Moments exact = exact_moments(one.problem, weights->weigh);
            std::vector<double> values =
                sample_estimates(one.problem, weighting, weights, 1, kRuns);
            EXPECT_GT(test::p_value_of_mean(values, exact.mean), kLevel) << what;
            for (double& value : values) value = std::pow(value - exact.mean, 2);
            EXPECT_GT(test::p_value_of_mean(values, exact.variance), kLevel) << what;
            const bool is_alone = weighting.name.ends_with("-alone");
            if (!is_alone) {
                EXPECT_NEAR(exact.mean, one.problem.integral(), 1e-8) << what;
            }
        }
    }
}

TEST(LabSampling, DrawsFromTheDensitiesWhateverTheLayout) {
    constexpr std::size_t kBins = 20;
    constexpr int kDraws = 5000;
    const Density density(
        Curve({{Linear{{0, 1}, 0, 2}, 1, {0, 1}}, {Gaussian{0.3, 0.05}, 0.5, {0, 1}}}, {0, 1}));
    for (const auto& [layout, cells] :
         {std::pair{Layout::Independent, 1}, std::pair{Layout::Stratified, 1},
          std::pair{Layout::Shared, 7}, std::pair{Layout::Shared, 1}}) {
        const Problem problem{"p",
                              "",
                              {0, 1},
                              Curve({{Uniform{}, 1, {0, 1}}}, {0, 1}),
                              {make_technique("t", density, 3, layout, cells)}};
        std::vector<double> observed(kBins);
        std::vector<double> expected(kBins);
        for (std::size_t b = 0; b < kBins; ++b) {
            expected[b] = kDraws * (density.cumulative((static_cast<double>(b) + 1) / kBins) -
                                    density.cumulative(static_cast<double>(b) / kBins));
        }
        for (std::uint32_t i = 0; i < kDraws; ++i) {
            Rng rng(3, i, 0);
            // One of the three at random, because they are not independent of each other.
            const double x = draw(problem, rng)[i % 3].x;
            ++observed[std::min(kBins - 1, static_cast<std::size_t>(x * kBins))];
        }
        EXPECT_GT(test::p_value_of_counts(observed, expected), kLevel);
    }
}

// f is 0 on a part of the domain, where samples count too. Samples without it would be biased by
// several per cent.
constexpr const char* kZeros = R"(name: zeros
problems:
  zeros:
    integrand: {shape: linear, from: 1, to: 2, support: [0, 0.6]}
    techniques:
      first: {density: {shape: uniform}}
      second: {density: {shape: linear, from: 0, to: 2}}
    weights:
      exact: {optimal: exact}
      progressive: {optimal: progressive, iterations: 8}
      progressive-long: {optimal: progressive, iterations: 200}
      direct: {optimal: direct, iterations: 500}
)";

TEST(LabSampling, OptimalEstimatorsCountZeros) {
    const Study study = read(kZeros);
    const Case& one = study.cases[0];
    const double integral = one.problem.integral();
    const auto estimates = [&](std::size_t weighting, int runs) {
        return sample_estimates(one.problem, one.weightings[weighting], std::nullopt, 1, runs);
    };
    EXPECT_GT(test::p_value_of_mean(estimates(1, kRuns), integral), kLevel);
    const std::vector<double> progressive = estimates(2, 1000);
    EXPECT_GT(test::p_value_of_mean(progressive, integral), kLevel);
    const std::vector<double> direct = estimates(3, 500);
    // Biased, but by less than one part in 500 of the integral here.
    double mean = 0;
    for (const double value : direct) mean += value / 500;
    EXPECT_NEAR(mean, integral, integral / 200);

    // Their variance tends to that of the exact weights, which is far below balance's.
    const auto exact = fix_weights(one.problem, one.weightings[0], 1);
    const double optimum = exact_moments(one.problem, exact->weigh).variance;
    const double balance =
        exact_moments(one.problem, fix_weights(one.problem, {"b", HeuristicWeights{}}, 1)->weigh)
            .variance;
    double variance = 0;
    for (const double value : progressive) variance += std::pow(value - integral, 2) * 200 / 1000;
    EXPECT_LT(optimum, 0.5 * balance);
    EXPECT_LT(variance, 1.3 * optimum);
    EXPECT_GT(variance, 0.8 * optimum);
}

// Two samples for two techniques, sometimes side by side where one density hides the other.
TEST(LabSampling, ProgressiveWeightsHaveNoWildBeginning) {
    const Study study = read(R"(name: defensive
problems:
  defensive:
    integrand: [{shape: gaussian, mean: 0.35, deviation: 0.12}, {shape: uniform, weight: 0.05}]
    techniques:
      uniform: {density: {shape: uniform}}
      proportional:
        density:
          - {shape: gaussian, mean: 0.36, deviation: 0.11, weight: 0.99}
          - {shape: uniform, weight: 0.01}
    weights:
      balance: {heuristic: balance}
      progressive: {optimal: progressive, iterations: 4}
)");
    const Case& one = study.cases[0];
    const auto balance = fix_weights(one.problem, one.weightings[0], 1);
    const double integral = one.problem.integral();
    double variance = 0;
    for (const double value :
         sample_estimates(one.problem, one.weightings[1], std::nullopt, 1, kRuns)) {
        variance += 4 * std::pow(value - integral, 2) / kRuns;
    }
    EXPECT_LT(variance, exact_moments(one.problem, balance->weigh).variance);
}

TEST(LabSampling, NothingIsBelowTheVarianceOfOptimalWeightsForIndependentSamples) {
    for (const Case& one : read(kFile).cases) {
        const bool has_shared = std::ranges::any_of(
            one.problem.techniques,
            [](const Technique& technique) { return technique.layout == Layout::Shared; });
        if (has_shared) continue;
        const double optimum =
            exact_moments(one.problem, fix_weights(one.problem, one.weightings.back(), 1)->weigh)
                .variance;
        for (const Weighting& weighting : one.weightings) {
            const auto weights = fix_weights(one.problem, weighting, 1);
            const Moments moments = exact_moments(one.problem, weights->weigh);
            EXPECT_LE(optimum, moments.variance + 1e-9) << one.problem.name << weighting.name;
        }
    }
}

}  // namespace
}  // namespace misbench::lab
