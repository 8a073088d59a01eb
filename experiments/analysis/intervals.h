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

struct Interval {
    double low = 0;
    double high = 0;
    bool operator==(const Interval&) const = default;
};

// Why an estimate has no interval.
enum class NoInterval {
    TooFewValues,  // fewer than kFewestForInterval seeds, on either side of a ratio
    NoSpread,      // all values are equal: that does not show their spread to be zero
    Unbounded,     // of a ratio: a mean is so little above zero that anything is possible
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

// mean(a)/mean(b) of two independent samples, with an interval by the delta method on its
// logarithm. Absent when either has no values or a mean that is not above zero: errors against the
// halves of a reference may be negative.
std::optional<Estimate> estimate_ratio(std::span<const double> a, std::span<const double> b);

}  // namespace misbench
