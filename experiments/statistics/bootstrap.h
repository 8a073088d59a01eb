// Intervals by the bootstrap-t: the distribution of t = (estimate - truth) / standard error is
// taken from values drawn again out of those that are there, instead of from Student's table. A
// check of the intervals in intervals.h, and the interval over scenes.
//
// The same values in the same order always give the same interval: the random numbers follow from
// them.
//
// [ET93]   B. Efron, R. J. Tibshirani, An Introduction to the Bootstrap, 1993, chapter 12.5.
#pragma once

#include <optional>
#include <span>

#include "experiments/statistics/intervals.h"

namespace misbench {

inline constexpr int kResamples = 999;

// The ratio of means, as log_ratio and paired_log_ratio give it. Coverage of the 95 % intervals of
// independent values, in percent, beside the delta method's (estimate_ratio); A/B:
//
//     COVERAGE_TABLE
//
// It agrees with the delta method but for unequal shapes and tails, where both are too short: then
// the tail is what to look at (tail.h).
std::optional<Estimate> bootstrap_ratio(std::span<const double> a, std::span<const double> b);
std::optional<Estimate> bootstrap_paired_ratio(std::span<const double> a,
                                               std::span<const double> b);

// The geometric mean of ratios (given by their logarithms) of scenes that stand for others like
// them: scenes are the population, so their spread is what counts, whatever it comes from. For what
// can be said of just these scenes, see mean_log_ratio. Absent without scenes; no interval below
// kFewestToResample of them. Coverage of the 95 % interval, in percent, with Student's t and the
// percentile bootstrap beside it, of log ratios that are normal, exponential, or of which 15 % are
// far off:
//
//                   normal                exponential             far off
//     scenes   this    t   perc.     this    t   perc.     this    t   perc.
//          5   95.3  95.4  83.8      92.1  88.8  78.9      79.0  73.2  60.5
//          6   94.8  95.2  86.2      92.5  89.9  81.6      76.3  72.0  63.3
//          8   95.0  94.9  88.2      92.5  89.7  84.3      78.2  75.5  72.4
//         10   94.8  95.0  90.2      93.5  91.0  87.0      80.9  80.2  78.8
//         20   94.8  94.8  93.1      94.2  91.8  90.3      94.5  91.2  91.5
//
// A method that fails in rare scenes is not seen by few: nothing of these numbers can help there.
std::optional<Estimate> geometric_mean_over_scenes(std::span<const double> log_ratios);

}  // namespace misbench
