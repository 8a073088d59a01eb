// Intervals hold what they promise, and the reference's noise cancels, by simulation. Every test
// has fixed seeds. Comparisons with a known distribution: four, at alpha = 0.001 for all of them
// together (Šidák: 3.66 standard errors for each), chosen before they were first run.
#include "experiments/statistics/intervals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "results/metrics/metrics.h"

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

// Errors of one seed that correlate because both methods use the same random numbers.
struct Pairs {
    std::vector<double> a;
    std::vector<double> b;
};

// Lognormal, mean ratio 1.
Pairs drawn_pairs(std::mt19937_64& random, int n, double spread_a, double spread_b, double rho) {
    std::normal_distribution<double> normal;
    const auto error = [](double z, double spread) {
        return std::exp(spread * z - spread * spread / 2);
    };
    Pairs pairs;
    for (int i = 0; i < n; ++i) {
        const double z = normal(random);
        pairs.a.push_back(error(z, spread_a));
        pairs.b.push_back(error(rho * z + std::sqrt(1 - rho * rho) * normal(random), spread_b));
    }
    return pairs;
}

// The numbers of the table in intervals.h.
TEST(PairedRatioInterval, HoldsTheRatioHoweverErrorsCorrelate) {
    constexpr int kTrials = 20'000;
    for (const int n : {3, 5, 10}) {
        for (const double rho : {-0.5, 0.0, 0.5, 0.95}) {
            const double share = coverage(kTrials, 1, [n, rho](std::mt19937_64& random) {
                const Pairs pairs = drawn_pairs(random, n, 0.5, 0.5, rho);
                return estimate_paired_ratio(pairs.a, pairs.b).value().interval.value();
            });
            EXPECT_NEAR(share, kConfidence, 0.025) << n << " " << rho;
        }
    }
}

// Why pairs are compared as pairs: taken for independent, errors that rise together look less
// certain than they are, and errors that fall when others rise look more certain.
TEST(PairedRatioInterval, IsNeededWhereErrorsCorrelate) {
    constexpr int kTrials = 5'000;
    const auto welch = [](double rho) {
        return coverage(kTrials, 1, [rho](std::mt19937_64& random) {
            const Pairs pairs = drawn_pairs(random, 10, 0.5, 0.5, rho);
            return estimate_ratio(pairs.a, pairs.b).value().interval.value();
        });
    };
    EXPECT_LT(welch(-0.5), 0.90);
    EXPECT_GT(welch(0.95), 0.995);
    std::mt19937_64 random(5);
    const Pairs pairs = drawn_pairs(random, 10, 0.5, 0.5, 0.95);
    const Interval paired = estimate_paired_ratio(pairs.a, pairs.b)->interval.value();
    const Interval unpaired = estimate_ratio(pairs.a, pairs.b)->interval.value();
    EXPECT_LT(std::log(paired.high / paired.low), 0.5 * std::log(unpaired.high / unpaired.low));
}

// At equal time the two methods of a pair end after different numbers of passes, which change the
// error and its correlation from seed to seed: the pairs are still drawn alike.
TEST(PairedRatioInterval, HoldsTheRatioAtEqualTime) {
    constexpr int kTrials = 20'000;
    constexpr double kPasses = 20;
    std::poisson_distribution<int> passes(kPasses);
    const auto error = [&passes](std::mt19937_64& random, double value) {
        return value * kPasses / (1 + passes(random));
    };
    for (const int n : {3, 5, 10}) {
        const double share = coverage(kTrials, 1, [&](std::mt19937_64& random) {
            Pairs pairs = drawn_pairs(random, n, 0.3, 0.3, 0.95);
            for (double& value : pairs.a) value = error(random, value);
            for (double& value : pairs.b) value = error(random, value);
            return estimate_paired_ratio(pairs.a, pairs.b).value().interval.value();
        });
        EXPECT_NEAR(share, kConfidence, 0.02) << n;
    }
}

// Ratios 1/2, 1, 2, 4 with spreads of their own: their geometric mean is the square root of 2.
TEST(MeanRatioInterval, HoldsTheGeometricMeanOverScenes) {
    constexpr int kTrials = 20'000;
    for (const int n : {3, 5, 10}) {
        const double share = coverage(kTrials, std::sqrt(2.0), [n](std::mt19937_64& random) {
            std::vector<LogRatio> scenes;
            for (int s = 0; s < 4; ++s) {
                Pairs pairs = drawn_pairs(random, n, 0.1 + 0.1 * s, 0.3, 0.5);
                for (double& value : pairs.a) value *= std::pow(2, s - 1);
                scenes.push_back(paired_log_ratio(pairs.a, pairs.b).value());
            }
            return to_ratio(mean_log_ratio(scenes)).interval.value();
        });
        EXPECT_NEAR(share, kConfidence, 0.02) << n;
    }
}

TEST(PairedRatioInterval, HasTheNumbersOfATextbook) {
    // a/mean(a) - b/mean(b): -1/4, 1/4, 0; t(0.975, 2) = 4.302653.
    const std::vector<double> a = {1, 3, 2};
    const std::vector<double> b = {3, 5, 4};
    const Estimate ratio = estimate_paired_ratio(a, b).value();
    EXPECT_DOUBLE_EQ(ratio.value, 0.5);
    EXPECT_NEAR(std::log(ratio.interval->high / 0.5), 4.302653 * std::sqrt(0.125 / 6), 1e-6);
    const Interval other = estimate_paired_ratio(b, a)->interval.value();
    EXPECT_DOUBLE_EQ(other.low, 1 / ratio.interval->high);
    EXPECT_DOUBLE_EQ(other.high, 1 / ratio.interval->low);
}

TEST(PairedRatioInterval, DegeneratePairsGiveNoIntervalAndTheReason) {
    using Values = std::vector<double>;
    const Values good = {1.0, 1.5, 1.25};
    EXPECT_EQ(estimate_paired_ratio(Values{}, Values{}), std::nullopt);
    EXPECT_EQ(estimate_paired_ratio(good, Values{-1.0, 1.0, 0.0}), std::nullopt);
    EXPECT_EQ(estimate_paired_ratio(Values{1, 2}, Values{1, 3})->why_none,
              NoInterval::TooFewValues);
    // In proportion, which a rounding error does not change.
    EXPECT_EQ(estimate_paired_ratio(Values{3.0, 4.5, 3.75}, good)->why_none, NoInterval::NoSpread);
    EXPECT_EQ(estimate_paired_ratio(Values{0.1, 0.15, 0.125}, good)->why_none,
              NoInterval::NoSpread);
    EXPECT_FALSE(paired_log_ratio(Values{3.0, 4.5, 3.75}, good)->is_identity);
    EXPECT_EQ(estimate_paired_ratio(good, Values{-1.0, 1.0, 1e-9})->why_none,
              NoInterval::Unbounded);
    const LogRatio same = paired_log_ratio(good, good).value();
    EXPECT_TRUE(same.is_identity);
    EXPECT_EQ(same.value, 0);
    EXPECT_FALSE(log_ratio(good, good)->is_identity);

    // Scenes where both do the same have no part in the uncertainty of the mean.
    const LogRatio other = paired_log_ratio(Values{1, 2, 3}, good).value();
    const LogRatio mean = mean_log_ratio(std::vector{same, other});
    EXPECT_DOUBLE_EQ(mean.variance, other.variance / 4);
    EXPECT_DOUBLE_EQ(mean.degrees_of_freedom, 2);
    EXPECT_TRUE(mean_log_ratio(std::vector{same, same}).is_identity);
    const LogRatio few = paired_log_ratio(Values{1, 2}, Values{1, 3}).value();
    EXPECT_EQ(mean_log_ratio(std::vector{few, other}).why_none, NoInterval::TooFewValues);
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
