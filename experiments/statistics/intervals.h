// Confidence intervals over seeds. Every value is the error of one independent render.
#pragma once

#include <optional>
#include <span>
#include <string>

namespace misbench {

// Of every interval in tables and reports.
inline constexpr double kConfidence = 0.95;
// With two values the t quantile is 12.7 and the estimate of the spread has one degree of freedom:
// such an interval says nothing but looks as if it did.
inline constexpr int kFewestForInterval = 3;
// Of four values drawn from four, one of 64 times all are the same: that bounds no interval.
inline constexpr int kFewestToResample = 5;

struct Interval {
    double low = 0;
    double high = 0;
    bool operator==(const Interval&) const = default;
};

// Why an estimate has no interval.
enum class NoInterval {
    TooFewValues,      // fewer than kFewestForInterval seeds, on either side of a ratio
    NoSpread,          // all values, or a ratio's pairs, are equal: that shows no spread of zero
    Unbounded,         // of a ratio: a mean is so little above zero that anything is possible
    HeavyTail,         // rare values carry the mean, and too few of them are there (tail.h)
    TooFewToResample,  // fewer than kFewestToResample values or scenes (bootstrap.h)
    NoEstimate,        // a number of these very seeds
};
// For a table's footnote: "fewer than 3 seeds".
std::string to_string(NoInterval reason);

struct Estimate {
    double value = 0;
    std::optional<Interval> interval;
    std::optional<NoInterval> why_none;  // set exactly when there is no interval
    bool operator==(const Estimate&) const = default;
};

bool excludes_one(const Estimate& ratio);

// Student's t interval. Absent without values.
std::optional<Estimate> estimate_mean(std::span<const double> values);

// The logarithm of a ratio of means, to first order a normal variable (delta method).
struct LogRatio {
    double value = 0;
    double variance = 0;                 // of `value`
    double degrees_of_freedom = 0;       // of the estimate of `variance`
    std::optional<NoInterval> why_none;  // set where the two above say nothing
    // Pairs that are bit by bit the same in every seed: both did the same work, and there is
    // nothing to estimate.
    bool is_identity = false;
};

// log(mean(a)/mean(b)). Absent when either has no values or a mean that is not above zero: errors
// against the halves of a reference may be negative. Of two independent samples, with Welch's
// degrees of freedom:
std::optional<LogRatio> log_ratio(std::span<const double> a, std::span<const double> b);
// Of pairs, a[i] and b[i] of one seed, which use the same random numbers: with the covariance over
// the seeds, and n - 1 degrees of freedom. Both have the same number of values.
//
// Pairing is right for whatever joins the two; Welch's interval is too short where the errors fall
// when the others rise, and too long where they rise together. So pairs are compared as pairs, at
// equal samples and at equal time. Coverage of the 95 % intervals, in percent, with the median
// length of the pairs' interval over that of Welch's, of lognormal errors with correlation rho
// (20 000 trials; spread 0.5 for both):
//
//              n = 3               n = 5               n = 10
//     rho     Welch pairs length  Welch pairs length  Welch pairs length
//    -0.5     92.1  95.0   1.58   89.2  94.4   1.39   88.4  94.2   1.28
//     0       96.3  94.4   1.23   94.3  93.8   1.12   94.3  94.0   1.05
//     0.5     98.5  94.1   0.90   98.6  93.8   0.80   98.8  94.0   0.76
//     0.95    99.9  93.5   0.32   100   93.0   0.27   100   93.2   0.25
//
// Where tails are heavier it falls to 90 (spread 0.8 for both) and 89 (0.2 and 0.8, rho 0.95, n =
// 10) for pairs, and to 88 and 89 for Welch's (rho -0.5): tables mark heavy tails.
std::optional<LogRatio> paired_log_ratio(std::span<const double> a, std::span<const double> b);
// Of the geometric mean of independent ratios, none of them absent and one at least.
LogRatio mean_log_ratio(std::span<const LogRatio> ratios);
// As a ratio of `n` seeds, two or more, would be with so many instead.
LogRatio with_seeds(LogRatio ratio, int n, int wanted);

// Of the two-sided test of a ratio of one, that is a `value` of zero; below 1 - confidence exactly
// where the interval of that confidence excludes one. 1 for an identity.
// REQUIRES: there is an interval, or it is an identity.
double p_value(const LogRatio& ratio);

// The ratio with its interval.
Estimate to_ratio(const LogRatio& ratio, double confidence = kConfidence);
std::optional<Estimate> estimate_ratio(std::span<const double> a, std::span<const double> b);
std::optional<Estimate> estimate_paired_ratio(std::span<const double> a, std::span<const double> b);

}  // namespace misbench
