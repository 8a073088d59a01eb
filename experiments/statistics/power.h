// How often a comparison finds a difference of a known size, and how many seeds that takes.
//
// [CP34]   C. J. Clopper, E. S. Pearson, The use of confidence or fiducial limits illustrated in
//          the case of the binomial, Biometrika 26, 1934.
#pragma once

#include <optional>
#include <span>

#include "experiments/statistics/intervals.h"

namespace misbench {

// Standard deviation over mean, of two values or more with a mean above zero; else 0.
double relative_spread(std::span<const double> values);

// That the interval of the ratio of two independent means of n seeds each excludes one, where the
// ratio is `ratio` and both have that relative spread: from the noncentral t distribution.
// REQUIRES: n >= 2.
double power_of_ratio(double ratio, double spread, int n);

// The fewest seeds that give power 80 %. Absent where it takes more than `most`.
std::optional<int> seeds_for_power(double ratio, double spread, int most);

// The 95 % interval of a probability of which `successes` of n were seen. [CP34]
Interval share_interval(double successes, double n);

}  // namespace misbench
