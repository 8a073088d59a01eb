// What statistical tests decide by.
#pragma once

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <span>
#include <vector>

namespace misbench::test {

// The level of each of m comparisons so that one false alarm among all has probability alpha.
inline double sidak(double alpha, int m) { return 1 - std::pow(1 - alpha, 1.0 / m); }

// The p-value of the values' mean being `expected`, by Student's t.
inline double p_value_of_mean(std::span<const double> values, double expected) {
    const auto n = static_cast<double>(values.size());
    double mean = 0;
    for (const double v : values) mean += v / n;
    double m2 = 0;
    for (const double v : values) m2 += (v - mean) * (v - mean);
    const double standard_error = std::sqrt(m2 / (n - 1) / n);
    // Constant values have no error but rounding.
    if (standard_error < 1e-6 * std::abs(expected)) {
        return std::abs(mean - expected) < 1e-5 * std::abs(expected) ? 1 : 0;
    }
    const boost::math::students_t t(n - 1);
    return 2 *
           boost::math::cdf(boost::math::complement(t, std::abs(mean - expected) / standard_error));
}

// Pearson's χ²: bins of fewer than 5 expected counts are pooled.
inline double p_value_of_counts(std::span<const double> observed,
                                std::span<const double> expected) {
    double statistic = 0;
    double pooled_observed = 0;
    double pooled_expected = 0;
    int n_bins = 0;
    const auto add = [&](double o, double e) {
        statistic += (o - e) * (o - e) / e;
        ++n_bins;
    };
    for (std::size_t i = 0; i < observed.size(); ++i) {
        if (expected[i] >= 5) {
            add(observed[i], expected[i]);
        } else {
            pooled_observed += observed[i];
            pooled_expected += expected[i];
        }
    }
    if (pooled_expected > 0) {
        add(pooled_observed, pooled_expected);
    } else if (pooled_observed > 0) {
        return 0;  // counts where none can be
    }
    if (n_bins == 1) return 1;  // everything is certain to be in one bin
    const boost::math::chi_squared chi2(n_bins - 1);
    return boost::math::cdf(boost::math::complement(chi2, statistic));
}

}  // namespace misbench::test
