// What curves of error against effort say: how fast an error falls, what it never falls below, when
// it is reached, and which of two methods is ahead when. Every interval is over the seeds: the
// points of one render are not independent, its seeds are.
//
// Slopes and floors are fitted to each seed. What lies on the mean curve (means over the seeds,
// joined by lines in log-log) has Student's t interval from the jackknife over seeds: with theta
// of all n seeds and theta_i of all but seed i, the values n theta - (n - 1) theta_i.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "experiments/statistics/intervals.h"

namespace misbench {

struct SeedCurves {
    std::vector<double> efforts;              // growing, above 0: passes or seconds
    std::vector<std::vector<double>> errors;  // of each seed, one an effort
};

// Means over the seeds. REQUIRES: at least one seed.
std::vector<double> mean_curve(const SeedCurves& curves);

// b of log error = a - b log effort: 1 where the error is the variance of independent samples,
// below where a bias remains or the tail is heavy. Absent with fewer than two efforts, and where an
// error is not above 0.
std::optional<Estimate> fit_slope(const SeedCurves& curves);

// c of error = a/effort + c, by least squares of the distances relative to the mean curve: what is
// left of it after endless passes, the squared bias. A fit may be negative: only an interval above
// 0 says that there is a floor. Absent with fewer than three efforts, and where a mean is not
// above 0.
std::optional<Estimate> fit_floor(const SeedCurves& curves);
inline bool has_floor(const Estimate& floor) { return floor.interval && floor.interval->low > 0; }

// Where the mean curve first reaches an error.
struct EffortTo {
    enum class Where {
        Within,  // between the first and the last effort
        Before,  // the first effort, which is below it already: at most this
        Beyond,  // extrapolated from the last effort by the slope of the mean curve
        Never,   // the curve does not fall, or its floor is above
    };
    Where where = Where::Never;
    std::optional<Estimate> effort;  // absent for Never
};
// Absent where a mean is not above 0. `floor` is of the same method over its passes: seconds are
// not proportional to them, so that over seconds fit_floor() may miss one.
std::optional<EffortTo> effort_to_reach(const SeedCurves& curves, double error,
                                        const std::optional<Estimate>& floor);

// Two methods with the same seeds, within the efforts that both have.
struct Crossover {
    int n_crossings = 0;             // of the mean curves
    bool is_first_ahead = false;     // a has the smaller error at the least common effort
    bool is_last_ahead = false;      // and at the largest
    std::optional<Estimate> effort;  // of the last crossing; absent without one
};
// Absent where there are no common efforts, a mean is not above 0, or nothing tells the two apart.
// REQUIRES: as many seeds in both, in the same order.
std::optional<Crossover> crossover(const SeedCurves& a, const SeedCurves& b);

struct CostAndError {
    double cost = 0;
    double error = 0;
};
// Whether no other point has both at most as large, and one of them smaller.
std::vector<bool> pareto_front(std::span<const CostAndError> points);

}  // namespace misbench
