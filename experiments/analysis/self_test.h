// Does the comparison find a difference where there is none, and one that is there? The seeds of
// each method are split at random into two made-up methods, which are the same; then one of them is
// made worse by a known part. Nothing is rendered.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/analysis/comparison.h"

namespace misbench {

inline constexpr int kFewestToSplit = 6;  // seeds: three for either half
inline constexpr int kSplits = 200;
inline constexpr double kPlanted = 0.05;
inline constexpr int kMostSeedsForPower = 10'000;

// A share of tests, and what it may be for other seeds as well.
struct TestedShare {
    double share = 0;
    // Clopper and Pearson's 95 % interval, as if each cell had been split once: splits of the same
    // seeds repeat each other.
    Interval interval;
};

struct SplitCell {
    std::string scene;
    std::string method;
    Budget budget;
    int n_seeds = 0;              // of the method; half of them on either side of a split
    double false_share = 0;       // of splits that differ, before any adjustment
    double found_share = 0;       // of splits in which kPlanted is found, before any adjustment
    double power = 0;             // to find it with all the seeds on either side, expected
    std::optional<int> n_needed;  // seeds for a power of 80 %; absent above kMostSeedsForPower
};

struct SelfTest {
    std::string experiment;
    std::string metric;
    double alpha = 1 - kConfidence;
    std::vector<SplitCell> cells;      // that have seeds enough
    std::vector<std::string> skipped;  // "Box, plain, 16 spp: 3 seeds", and the like
    // Over cells and splits: differences of a cell taken alone, and those that stay after
    // Benjamini and Hochberg over the split's table.
    TestedShare alone;
    TestedShare adjusted;
    // kPlanted in one cell of the table, all others without a difference.
    double found_alone = 0;
    double found_adjusted = 0;

    // Its intervals hold what they may at most be: alpha.
    bool passes() const { return alone.interval.low <= alpha && adjusted.interval.low <= alpha; }
};

// The same splits for the same values.
SelfTest self_test(const Comparison& comparison);

}  // namespace misbench
