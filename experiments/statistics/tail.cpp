#include "experiments/statistics/tail.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace misbench {
namespace {

constexpr double kFarOut = 4;         // times the median
constexpr double kShareOfTail = 0.2;  // of the sum of all values
constexpr int kFewestOfTail = 2;

std::optional<double> median(std::vector<double> values) {
    if (values.size() < kFewestForInterval) return std::nullopt;
    std::ranges::sort(values);
    const std::size_t middle = values.size() / 2;
    const double median =
        values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
    return median > 0 ? std::optional(median) : std::nullopt;
}

// Sums of values in units of their median.
struct TailShare {
    double tail = 0;
    double all = 0;
    int n_tail = 0;

    void add(std::span<const double> values) {
        const std::optional<double> unit = median({values.begin(), values.end()});
        if (!unit) return;
        for (const double value : values) {
            const double relative = value / *unit;
            all += relative;
            if (relative <= kFarOut) continue;
            tail += relative;
            ++n_tail;
        }
    }
};

}  // namespace

std::optional<double> max_over_median(std::span<const double> values) {
    const std::optional<double> unit = median({values.begin(), values.end()});
    return unit ? std::optional(*std::ranges::max_element(values) / *unit) : std::nullopt;
}

std::string to_string(TailVerdict verdict) {
    switch (verdict) {
        case TailVerdict::Calm:
            return "calm";
        case TailVerdict::Heavy:
            return "heavy";
        case TailVerdict::Dishonest:
            break;
    }
    return "dishonest";
}

TailVerdict judge_tail(std::span<const double> values, std::span<const std::vector<double>> kin) {
    TailShare share;
    share.add(values);
    const int n_own = share.n_tail;
    for (const std::vector<double>& others : kin) share.add(others);
    if (share.tail > kShareOfTail * share.all && n_own < kFewestOfTail) {
        return TailVerdict::Dishonest;
    }
    const std::optional<double> tail = max_over_median(values);
    return tail && *tail > kHeavyTail ? TailVerdict::Heavy : TailVerdict::Calm;
}

}  // namespace misbench
