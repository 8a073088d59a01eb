#include "experiments/statistics/bootstrap.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "renderer/base/rng.h"

namespace misbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRounding = 1e-12;  // a spread of logarithms below it is none

// Of the bits of the values, FNV-1a by words.
std::int64_t seed_of(std::span<const double> a, std::span<const double> b = {}) {
    std::uint64_t hash = 0xcbf29ce484222325U;
    for (const std::span<const double> values : {a, b}) {
        for (const double value : values) {
            hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001b3U;
            hash ^= hash >> 32U;
        }
    }
    return std::bit_cast<std::int64_t>(hash);
}

std::size_t drawn_index(Rng& rng, std::size_t n) {
    return static_cast<std::size_t>(static_cast<double>(rng.uniform()) * static_cast<double>(n));
}

// A drawn value of t. Infinite where the values drawn are all the same, and where a ratio of means
// has no logarithm.
double t_of(const std::optional<LogRatio>& drawn, double truth) {
    if (!drawn) return kInfinity;
    const double distance = drawn->value - truth;
    if (drawn->variance <= 0) return std::copysign(kInfinity, distance);
    return distance / std::sqrt(drawn->variance);
}

// [ET93, (12.22)]: the upper end of t gives the lower end of the interval.
Estimate interval_of(double value, double standard_error, std::vector<double> t) {
    std::ranges::sort(t);
    const double one_end = (1 - kConfidence) / 2;
    const auto rank = static_cast<std::size_t>(std::lround(one_end * (kResamples + 1))) - 1;
    const double low = std::exp(value - t[t.size() - 1 - rank] * standard_error);
    const double high = std::exp(value - t[rank] * standard_error);
    if (!(low > 0 && std::isfinite(high))) {
        return {
            .value = std::exp(value), .interval = std::nullopt, .why_none = NoInterval::Unbounded};
    }
    return {.value = std::exp(value),
            .interval = Interval{.low = low, .high = high},
            .why_none = std::nullopt};
}

Estimate without_interval(double log_value, NoInterval reason) {
    return {.value = std::exp(log_value), .interval = std::nullopt, .why_none = reason};
}

}  // namespace

std::optional<Estimate> bootstrap_ratio(std::span<const double> a, std::span<const double> b) {
    const std::optional<LogRatio> ratio = log_ratio(a, b);
    if (!ratio) return std::nullopt;
    if (std::min(a.size(), b.size()) < kFewestToResample) {
        return without_interval(ratio->value, NoInterval::TooFewToResample);
    }
    if (ratio->why_none) return without_interval(ratio->value, *ratio->why_none);
    Rng rng(seed_of(a, b), 0, 0);
    std::vector<double> drawn_a(a.size());
    std::vector<double> drawn_b(b.size());
    std::vector<double> t;
    for (int i = 0; i < kResamples; ++i) {
        for (double& value : drawn_a) value = a[drawn_index(rng, a.size())];
        for (double& value : drawn_b) value = b[drawn_index(rng, b.size())];
        t.push_back(t_of(log_ratio(drawn_a, drawn_b), ratio->value));
    }
    return interval_of(ratio->value, std::sqrt(ratio->variance), std::move(t));
}

std::optional<Estimate> bootstrap_paired_ratio(std::span<const double> a,
                                               std::span<const double> b) {
    const std::optional<LogRatio> ratio = paired_log_ratio(a, b);
    if (!ratio) return std::nullopt;
    if (a.size() < kFewestToResample) {
        return without_interval(ratio->value, NoInterval::TooFewToResample);
    }
    if (ratio->why_none) return without_interval(ratio->value, *ratio->why_none);
    Rng rng(seed_of(a, b), 0, 0);
    std::vector<double> drawn_a(a.size());
    std::vector<double> drawn_b(b.size());
    std::vector<double> t;
    for (int i = 0; i < kResamples; ++i) {
        for (std::size_t k = 0; k < a.size(); ++k) {
            const std::size_t pair = drawn_index(rng, a.size());
            drawn_a[k] = a[pair];
            drawn_b[k] = b[pair];
        }
        t.push_back(t_of(paired_log_ratio(drawn_a, drawn_b), ratio->value));
    }
    return interval_of(ratio->value, std::sqrt(ratio->variance), std::move(t));
}

std::optional<Estimate> geometric_mean_over_scenes(std::span<const double> log_ratios) {
    if (log_ratios.empty()) return std::nullopt;
    const auto n = static_cast<double>(log_ratios.size());
    // Mean and variance of the mean.
    const auto moments = [n](std::span<const double> values) {
        LogRatio mean{.why_none = std::nullopt};
        for (const double value : values) mean.value += value / n;
        for (const double value : values) {
            mean.variance += (value - mean.value) * (value - mean.value) / (n * (n - 1));
        }
        if (mean.variance <= kRounding * kRounding) mean.variance = 0;
        return mean;
    };
    const LogRatio mean = moments(log_ratios);
    if (log_ratios.size() < kFewestToResample) {
        return without_interval(mean.value, NoInterval::TooFewToResample);
    }
    if (mean.variance <= 0) return without_interval(mean.value, NoInterval::NoSpread);
    Rng rng(seed_of(log_ratios), 0, 0);
    std::vector<double> drawn(log_ratios.size());
    std::vector<double> t;
    for (int i = 0; i < kResamples; ++i) {
        for (double& value : drawn) value = log_ratios[drawn_index(rng, log_ratios.size())];
        t.push_back(t_of(moments(drawn), mean.value));
    }
    return interval_of(mean.value, std::sqrt(mean.variance), std::move(t));
}

}  // namespace misbench
