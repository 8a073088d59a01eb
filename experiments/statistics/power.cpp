#include "experiments/statistics/power.h"

#include <algorithm>
#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/non_central_t.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "experiments/statistics/tile_test.h"
#include "renderer/base/check.h"

namespace misbench {

double relative_spread(std::span<const double> values) {
    if (values.size() < 2) return 0;
    const auto n = static_cast<double>(values.size());
    double mean = 0;
    for (const double value : values) mean += value / n;
    if (mean <= 0) return 0;
    double sum_of_squares = 0;
    for (const double value : values) sum_of_squares += (value - mean) * (value - mean);
    return std::sqrt(sum_of_squares / (n - 1)) / mean;
}

double power_of_ratio(double ratio, double spread, int n) {
    MISBENCH_CHECK(n >= 2 && ratio > 0);
    if (spread <= 0) return ratio == 1 ? 0 : 1;
    const double degrees_of_freedom = 2.0 * (n - 1);
    const double distance = std::abs(std::log(ratio)) / (spread * std::sqrt(2.0 / n));
    const boost::math::students_t student(degrees_of_freedom);
    const double limit = boost::math::quantile(student, 0.5 + kConfidence / 2);
    // Far off the distribution is normal, and its own series does not converge.
    if (distance > 2 * limit + 10) return 1;
    const boost::math::non_central_t shifted(degrees_of_freedom, distance);
    return boost::math::cdf(boost::math::complement(shifted, limit)) +
           boost::math::cdf(shifted, -limit);
}

std::optional<int> seeds_for_power(double ratio, double spread, int most) {
    int high = kFewestForInterval;
    while (power_of_ratio(ratio, spread, high) < kPower) {
        if (high >= most) return std::nullopt;
        high = std::min(2 * high, most);
    }
    int low = kFewestForInterval - 1;  // power rises with the seeds
    while (high - low > 1) {
        const int middle = low + (high - low) / 2;
        (power_of_ratio(ratio, spread, middle) < kPower ? low : high) = middle;
    }
    return high;
}

Interval share_interval(double successes, double n) {
    MISBENCH_CHECK(n > 0 && successes >= 0 && successes <= n);
    const double one_end = (1 - kConfidence) / 2;
    using boost::math::beta_distribution;
    using boost::math::quantile;
    return {.low = successes > 0
                       ? quantile(beta_distribution(successes, n - successes + 1), one_end)
                       : 0,
            .high = successes < n ? quantile(boost::math::complement(
                                        beta_distribution(successes + 1, n - successes), one_end))
                                  : 1};
}

}  // namespace misbench
