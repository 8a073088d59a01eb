// Which renders come next, so that ratios to a baseline are soon known well enough.
//
// A ratio is of pairs: the n seeds of its method, and the baseline's of the same numbers. Pairs are
// kept because Welch's interval is wrong where the errors of a seed correlate (intervals.h); so the
// baseline always has as many seeds as the method that has most, and a seed of a method that the
// baseline lacks costs a seed of both. All ratios of a scene share the baseline's seeds.
//
// A ratio is narrow when its 95 % interval is within [ratio/(1 + h), ratio·(1 + h)]: a rule of
// fixed width [CR65], which keeps the coverage of the interval near its level
// (allocation_test.cpp). It does not look at where the ratio lies. To stop as soon as a difference
// is significant would make significant differences out of noise.
//
// The next seeds go to the wide ratios, each where it takes most from the sum of the variances of
// their logarithms a second: of a ratio with variance v/n, one further pair takes v/(n(n + 1)) and
// costs c seconds, which leads to n proportional to √(v/c) [Ney34]. Variances come from few seeds
// at first. Therefore a round is short: it takes half the time that the wide ratios' seeds took so
// far, at most doubles the seeds of a ratio, and gives none more than it needs by its present
// variance.
//
// [Ney34]  J. Neyman, On the two different aspects of the representative method, Journal of the
//          Royal Statistical Society 97, 1934.
// [CR65]   Y. S. Chow, H. Robbins, On the asymptotic theory of fixed-width sequential confidence
//          intervals for the mean, Annals of Mathematical Statistics 36, 1965.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "experiments/statistics/intervals.h"

namespace misbench {

// What is rendered of the baseline of a scene.
struct RenderedBaseline {
    int n = 0;           // seeds
    double seconds = 0;  // of one
};

struct RenderedRatio {
    std::size_t baseline = 0;       // which one
    int n = 0;                      // seeds of the method, kFewestForInterval or more
    int most_seeds = 0;             // that the method can have; what is there may be more
    double seconds = 0;             // of one
    std::optional<LogRatio> ratio;  // of n pairs; absent where a mean is not above zero
};

// `halfwidth` is h above. Pairs without any spread are narrow too: no number of seeds would give
// them an interval.
bool is_narrow(const std::optional<LogRatio>& ratio, double halfwidth);

// The number of seeds of each ratio's method after the next round; none is less than before. All as
// before: there is nothing to do, every ratio is narrow or has its most seeds. REQUIRES: no
// baseline has fewer seeds than a method compared with it.
std::vector<int> allocate(std::span<const RenderedBaseline> baselines,
                          std::span<const RenderedRatio> ratios, double halfwidth);

}  // namespace misbench
