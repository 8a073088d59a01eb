// [Welch47]  B. L. Welch, The generalization of "Student's" problem when several different
//            population variances are involved, Biometrika 34, 1947.
#include "experiments/analysis/intervals.h"

#include <boost/math/distributions/students_t.hpp>
#include <cmath>

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

double two_sided_t(double degrees_of_freedom) {
    return boost::math::quantile(boost::math::students_t(degrees_of_freedom),
                                 0.5 + kConfidence / 2);
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
            return "all seeds give the same value";
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
    const double half_width = two_sided_t(m.n - 1) * std::sqrt(m.variance / m.n);
    return Estimate{.value = m.mean,
                    .interval = Interval{.low = m.mean - half_width, .high = m.mean + half_width},
                    .why_none = std::nullopt};
}

std::optional<Estimate> estimate_ratio(std::span<const double> a, std::span<const double> b) {
    if (a.empty() || b.empty()) return std::nullopt;
    const Moments ma = moments(a);
    const Moments mb = moments(b);
    if (!(ma.mean > 0 && mb.mean > 0)) return std::nullopt;
    const double ratio = ma.mean / mb.mean;
    if (std::min(ma.n, mb.n) < kFewestForInterval) {
        return without_interval(ratio, NoInterval::TooFewValues);
    }
    // Variance of the logarithm of each mean, to first order.
    const double va = ma.variance / (ma.n * ma.mean * ma.mean);
    const double vb = mb.variance / (mb.n * mb.mean * mb.mean);
    if (va + vb <= 0) return without_interval(ratio, NoInterval::NoSpread);
    const double degrees_of_freedom =
        (va + vb) * (va + vb) / (va * va / (ma.n - 1) + vb * vb / (mb.n - 1));  // [Welch47]
    const double half_width = two_sided_t(degrees_of_freedom) * std::sqrt(va + vb);
    const Interval interval{.low = ratio * std::exp(-half_width),
                            .high = ratio * std::exp(half_width)};
    if (!(interval.low > 0 && std::isfinite(interval.high))) {
        return without_interval(ratio, NoInterval::Unbounded);
    }
    return Estimate{.value = ratio, .interval = interval, .why_none = std::nullopt};
}

}  // namespace misbench
