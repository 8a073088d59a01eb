// [Welch47]  B. L. Welch, The generalization of "Student's" problem when several different
//            population variances are involved, Biometrika 34, 1947.
#include "experiments/statistics/intervals.h"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "renderer/base/check.h"

namespace misbench {
namespace {

struct Moments {
    double n = 0;
    double mean = 0;
    double variance = 0;  // of one value, unbiased; 0 for a single one
};

Moments moments(std::span<const double> values) {
    double n = 0;
    double mean = 0;
    double sum_of_squares = 0;  // of the distances from the mean
    for (const double value : values) {
        n += 1;
        const double distance = value - mean;
        mean += distance / n;
        sum_of_squares += distance * (value - mean);
    }
    return {.n = n, .mean = mean, .variance = n > 1 ? sum_of_squares / (n - 1) : 0};
}

double two_sided_t(double degrees_of_freedom, double confidence) {
    return boost::math::quantile(boost::math::students_t(degrees_of_freedom), 0.5 + confidence / 2);
}

// Relative spread of pairs' ratios below which it is rounding.
constexpr double kRounding = 1e-12;

// Without its variance. Absent for a mean that is not above zero, as of no values.
std::optional<LogRatio> ratio_of(const Moments& a, const Moments& b) {
    if (!(a.mean > 0 && b.mean > 0)) return std::nullopt;
    LogRatio ratio{.value = std::log(a.mean / b.mean), .why_none = std::nullopt};
    if (std::min(a.n, b.n) < kFewestForInterval) ratio.why_none = NoInterval::TooFewValues;
    return ratio;
}

Estimate without_interval(double value, NoInterval reason) {
    return {.value = value, .interval = std::nullopt, .why_none = reason};
}

}  // namespace

std::string to_string(NoInterval reason) {
    switch (reason) {
        case NoInterval::TooFewValues:
            return "fewer than " + std::to_string(kFewestForInterval) + " seeds";
        case NoInterval::NoSpread:
            return "all seeds give the same value, or the same ratio";
        case NoInterval::HeavyTail:
            return "rare seeds carry a mean, and fewer than two of them were met: more seeds would "
                   "tell";
        case NoInterval::TooFewToResample:
            return "fewer than " + std::to_string(kFewestToResample) +
                   " values or scenes to draw from";
        case NoInterval::NoEstimate:
            return "it describes these seeds and no others";
        case NoInterval::Unbounded:
            break;
    }
    return "a mean is hardly above zero";
}

bool excludes_one(const Estimate& ratio) {
    return ratio.interval && (ratio.interval->low > 1 || ratio.interval->high < 1);
}

std::optional<Estimate> estimate_mean(std::span<const double> values) {
    if (values.empty()) return std::nullopt;
    const Moments m = moments(values);
    if (m.n < kFewestForInterval) return without_interval(m.mean, NoInterval::TooFewValues);
    if (m.variance <= 0) return without_interval(m.mean, NoInterval::NoSpread);
    const double half_width = two_sided_t(m.n - 1, kConfidence) * std::sqrt(m.variance / m.n);
    return Estimate{.value = m.mean,
                    .interval = Interval{.low = m.mean - half_width, .high = m.mean + half_width},
                    .why_none = std::nullopt};
}

std::optional<LogRatio> log_ratio(std::span<const double> a, std::span<const double> b) {
    const Moments ma = moments(a);
    const Moments mb = moments(b);
    std::optional<LogRatio> ratio = ratio_of(ma, mb);
    if (!ratio || ratio->why_none) return ratio;
    // Variance of the logarithm of each mean, to first order.
    const double va = ma.variance / (ma.n * ma.mean * ma.mean);
    const double vb = mb.variance / (mb.n * mb.mean * mb.mean);
    ratio->variance = va + vb;
    if (ratio->variance <= 0) {
        ratio->why_none = NoInterval::NoSpread;
        return ratio;
    }
    ratio->degrees_of_freedom =
        (va + vb) * (va + vb) / (va * va / (ma.n - 1) + vb * vb / (mb.n - 1));  // [Welch47]
    return ratio;
}

std::optional<LogRatio> paired_log_ratio(std::span<const double> a, std::span<const double> b) {
    MISBENCH_CHECK(a.size() == b.size());
    const Moments ma = moments(a);
    const Moments mb = moments(b);
    std::optional<LogRatio> ratio = ratio_of(ma, mb);
    if (!ratio || ratio->why_none) return ratio;
    // To first order log(mean(a)/mean(b)) is the mean of these, whose own mean is zero.
    double sum_of_squares = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double difference = a[i] / ma.mean - b[i] / mb.mean;
        sum_of_squares += difference * difference;
    }
    ratio->degrees_of_freedom = ma.n - 1;
    ratio->variance = sum_of_squares / (ma.n * ratio->degrees_of_freedom);
    if (ratio->variance <= kRounding * kRounding) ratio->why_none = NoInterval::NoSpread;
    ratio->is_identity = std::ranges::equal(a, b);
    return ratio;
}

LogRatio mean_log_ratio(std::span<const LogRatio> ratios) {
    MISBENCH_CHECK(!ratios.empty());
    const auto n = static_cast<double>(ratios.size());
    LogRatio mean{.why_none = std::nullopt};
    double sum_of_squares = 0;  // of the variances, each over its degrees of freedom
    for (const LogRatio& ratio : ratios) {
        mean.value += ratio.value / n;
        if (ratio.is_identity) continue;
        if (ratio.why_none) mean.why_none = ratio.why_none;
        const double share = ratio.variance / (n * n);
        mean.variance += share;
        sum_of_squares += share * share / ratio.degrees_of_freedom;
    }
    if (mean.why_none) return mean;
    if (mean.variance <= 0) {
        mean.why_none = NoInterval::NoSpread;
        mean.is_identity = true;
        return mean;
    }
    mean.degrees_of_freedom = mean.variance * mean.variance / sum_of_squares;  // [Welch47]
    return mean;
}

LogRatio with_seeds(LogRatio ratio, int n, int wanted) {
    ratio.variance *= static_cast<double>(n) / wanted;
    ratio.degrees_of_freedom *= static_cast<double>(wanted - 1) / (n - 1);
    return ratio;
}

double p_value(const LogRatio& ratio) {
    if (ratio.is_identity) return 1;
    MISBENCH_CHECK(!ratio.why_none);
    const boost::math::students_t t(ratio.degrees_of_freedom);
    return 2 * boost::math::cdf(
                   boost::math::complement(t, std::abs(ratio.value) / std::sqrt(ratio.variance)));
}

Estimate to_ratio(const LogRatio& ratio, double confidence) {
    const double value = std::exp(ratio.value);
    if (ratio.why_none) return without_interval(value, *ratio.why_none);
    const double half_width =
        two_sided_t(ratio.degrees_of_freedom, confidence) * std::sqrt(ratio.variance);
    const Interval interval{.low = std::exp(ratio.value - half_width),
                            .high = std::exp(ratio.value + half_width)};
    if (!(interval.low > 0 && std::isfinite(interval.high))) {
        return without_interval(value, NoInterval::Unbounded);
    }
    return {.value = value, .interval = interval, .why_none = std::nullopt};
}

std::optional<Estimate> estimate_ratio(std::span<const double> a, std::span<const double> b) {
    const std::optional<LogRatio> ratio = log_ratio(a, b);
    return ratio ? std::optional(to_ratio(*ratio)) : std::nullopt;
}

std::optional<Estimate> estimate_paired_ratio(std::span<const double> a,
                                              std::span<const double> b) {
    const std::optional<LogRatio> ratio = paired_log_ratio(a, b);
    return ratio ? std::optional(to_ratio(*ratio)) : std::nullopt;
}

}  // namespace misbench
