// Intervals hold what they promise, and the reference's noise cancels, by simulation. Every test
// has fixed seeds. Comparisons with a known distribution: four, at alpha = 0.001 for all of them
// together (Šidák: 3.66 standard errors for each), chosen before they were first run.
#include "experiments/analysis/intervals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "results/metrics.h"

namespace misbench {
namespace {

constexpr double kStandardErrors = 3.66;

std::vector<double> drawn(std::mt19937_64& random, int n, auto distribution) {
    std::vector<double> values;
    for (int i = 0; i < n; ++i) values.push_back(distribution(random));
    return values;
}

// Share of the intervals that hold the truth.
double coverage(int n_trials, double truth, const auto& interval_of) {
    std::mt19937_64 random(20240607);
    int n_holding = 0;
    for (int trial = 0; trial < n_trials; ++trial) {
        const Interval interval = interval_of(random);
        n_holding += interval.low <= truth && truth <= interval.high ? 1 : 0;
    }
    return static_cast<double>(n_holding) / n_trials;
}

double standard_error(double share, int n) { return std::sqrt(share * (1 - share) / n); }

TEST(MeanInterval, HoldsTheMeanOfNormalValuesAsOftenAsItSays) {
    constexpr int kTrials = 20'000;
    for (const int n : {3, 5, 20}) {
        const double share = coverage(kTrials, 7.0, [n](std::mt19937_64& random) {
            const auto values = drawn(random, n, std::normal_distribution<double>(7, 2));
            return estimate_mean(values).value().interval.value();
        });
        EXPECT_NEAR(share, kConfidence, kStandardErrors * standard_error(kConfidence, kTrials))
            << n;
    }
}

// The delta method is an approximation, so its coverage is compared with the simulated one of the
// literature: 94 to 96.5 % for lognormal errors (spread 0.5) at 3 to 20 seeds.
TEST(RatioInterval, HoldsTheRatioOfLognormalErrorsWithinTwoPercent) {
    constexpr int kTrials = 20'000;
    for (const int n : {3, 5, 10, 20}) {
        const double share = coverage(kTrials, 2.0, [n](std::mt19937_64& random) {
            const auto a = drawn(random, n, std::lognormal_distribution<double>(std::log(2), 0.5));
            const auto b = drawn(random, n, std::lognormal_distribution<double>(0, 0.5));
            return estimate_ratio(a, b).value().interval.value();
        });
        EXPECT_NEAR(share, kConfidence, 0.02) << n;
    }
}

// Method and baseline with different spreads and numbers of seeds: that is what Welch's degrees of
// freedom are for. Those of pooled variances leave the two percent.
TEST(RatioInterval, HoldsTheRatioOfUnequalSamples) {
    constexpr int kTrials = 20'000;
    const double share = coverage(kTrials, 1.2, [](std::mt19937_64& random) {
        const auto a = drawn(random, 4, std::normal_distribution<double>(12, 2));
        const auto b = drawn(random, 12, std::normal_distribution<double>(10, 0.3));
        return estimate_ratio(a, b).value().interval.value();
    });
    EXPECT_NEAR(share, kConfidence, 0.02);
}

TEST(RatioInterval, IsTheSameSeenFromTheOtherSide) {
    const std::vector<double> a = {1.0, 1.5, 1.25, 2.0};
    const std::vector<double> b = {3.0, 2.5, 3.5};
    const Estimate ab = estimate_ratio(a, b).value();
    const Estimate ba = estimate_ratio(b, a).value();
    EXPECT_DOUBLE_EQ(ab.interval->low, 1 / ba.interval->high);
    EXPECT_DOUBLE_EQ(ab.interval->high, 1 / ba.interval->low);
    EXPECT_TRUE(excludes_one(ab));
    EXPECT_FALSE(excludes_one(estimate_ratio(a, a).value()));
}

TEST(MeanInterval, HasTheNumbersOfATextbook) {
    // Mean 3, variance 2.5, t(0.975, 4) = 2.776445.
    const Estimate estimate = estimate_mean(std::vector<double>{1, 2, 3, 4, 5}).value();
    EXPECT_DOUBLE_EQ(estimate.value, 3);
    EXPECT_NEAR(estimate.interval->high - 3, 2.776445 * std::sqrt(2.5 / 5), 1e-6);
    EXPECT_EQ(estimate.why_none, std::nullopt);
}

TEST(Intervals, DegenerateValuesGiveNoIntervalAndTheReason) {
    using Values = std::vector<double>;
    const Values good = {1.0, 1.5, 1.25};
    EXPECT_EQ(estimate_mean(Values{}), std::nullopt);
    EXPECT_EQ(estimate_mean(Values{1.0})->why_none, NoInterval::TooFewValues);
    EXPECT_EQ(estimate_mean(Values{1.0, 2.0})->why_none, NoInterval::TooFewValues);
    EXPECT_EQ(estimate_mean(Values{0.1, 0.1, 0.1})->why_none, NoInterval::NoSpread);
    EXPECT_TRUE(estimate_mean(Values{-0.1, 0.1, -0.3})->interval);

    EXPECT_EQ(estimate_ratio(good, Values{}), std::nullopt);
    EXPECT_EQ(estimate_ratio(Values{}, good), std::nullopt);
    EXPECT_EQ(estimate_ratio(good, Values{-1.0, 1.0, 0.0}), std::nullopt);
    EXPECT_EQ(estimate_ratio(Values{0.0, 0.0, 0.0}, good), std::nullopt);
    EXPECT_EQ(estimate_ratio(Values{-1.0, -2.0, 0.5}, good), std::nullopt);
    EXPECT_EQ(estimate_ratio(good, Values{1.0, 2.0})->why_none, NoInterval::TooFewValues);
    EXPECT_EQ(estimate_ratio(Values{0.1, 0.1, 0.1}, Values{0.2, 0.2, 0.2})->why_none,
              NoInterval::NoSpread);
    EXPECT_EQ(estimate_ratio(good, Values{-1.0, 1.0, 1e-9})->why_none, NoInterval::Unbounded);
    for (const NoInterval reason :
         {NoInterval::TooFewValues, NoInterval::NoSpread, NoInterval::Unbounded}) {
        EXPECT_FALSE(to_string(reason).empty());
    }
}

// E[(I-r1)(I-r2)] = Var I + Bias², however noisy the reference is: here half as much again as the
// image. The mean over all pixels of many images against its own standard error.
TEST(ProductOfDifferences, IsTheVarianceAndTheSquaredBiasWithoutTheNoiseOfTheReference) {
    constexpr int kImages = 400;
    constexpr double kBias = 0.5;
    constexpr double kSpread = 1.0;
    constexpr double kReferenceSpread = 1.5;
    std::mt19937_64 random(7);
    const auto noisy = [&random](double mean, double spread) {
        Image image(16, 16);
        std::normal_distribution<double> normal(mean, spread);
        for (float& value : image.rgb) value = static_cast<float>(normal(random));
        return image;
    };
    std::vector<double> errors;
    for (int i = 0; i < kImages; ++i) {
        const Image image = noisy(3 + kBias, kSpread);
        const Image a = noisy(3, kReferenceSpread);
        const Image b = noisy(3, kReferenceSpread);
        errors.push_back(measure(find_metric("mse"), image, {a, b}));
    }
    const Estimate estimate = estimate_mean(errors).value();
    const double standard = (estimate.interval->high - estimate.value) / 1.966;
    EXPECT_NEAR(estimate.value, kSpread * kSpread + kBias * kBias, kStandardErrors * standard);
    EXPECT_LT(standard, 0.02);  // sharp enough to see the reference's variance of 2.25 / 2
}

}  // namespace
}  // namespace misbench
