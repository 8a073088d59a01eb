// What the runs of an experiment make of its claims. With [low, high] the 95 % interval of the
// ratio R, and m the claim's margin:
//
//   expect      reproduced                        not reproduced
//   less        high < 1                          else, low > 1/(1 + m)
//   more        low > 1                           else, high < 1 + m
//   not_more    high < 1 + m                      low > 1 + m
//   not_less    low > 1/(1 + m)                   high < 1/(1 + m)
//   equal       1/(1 + m) < low, high < 1 + m     high < 1/(1 + m) or low > 1 + m
//
// and not decided otherwise. So each finding is a statement about R, and wrong for at most 5 % of
// the experiments: "reproduced" says that the claim holds, "not reproduced" that it does not hold,
// for less and more: not by more than the margin. (Either end of an interval is exceeded with
// 2.5 %, as far as its coverage in intervals.h goes.) Over several scenes s:
//
//   each    one finding for each scene, each with its own 5 %
//   mean    R is the geometric mean of the R_s, the scenes being independent
//   worst   R is the largest R_s. high is the largest of the scenes' upper ends: it is too small
//           only if that of the worst scene is. low is the largest of their lower ends, too large
//           if any of them is: so each is one of a share of 5 % / number of scenes (Bonferroni,
//           whatever joins the scenes).
//   best    the smallest, with ends exchanged
//
// Where both methods have the same error in every seed, bit by bit, they did the same: R = 1.
// Fewer than kFewestForInterval seeds, and intervals that cannot be given, decide nothing. Where a
// planned run is missing, failed or invalid nothing is said either: those that are left are a
// selection.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiments/analysis/comparison.h"

namespace misbench {

enum class Finding { Reproduced, NotReproduced, NotDecided, NotMeasured };
std::string to_string(Finding finding);  // "reproduced", "not reproduced", …

Finding judge(const Claim& claim, const Interval& ratio);

struct OverScenes {
    Estimate ratio;
    std::size_t scene = 0;  // the worst or the best one, by its ratio
};
// The ratio that a claim is about, from those of its scenes; one for ClaimOver::Each.
OverScenes combine(ClaimOver over, std::span<const LogRatio> scenes);

// One line of a claim: all of it, or one scene where it is over each.
struct ClaimFinding {
    Claim claim;
    std::string scene;              // over each; of worst and best the one that it is; "" for mean
    std::optional<Estimate> ratio;  // of what is measured so far
    std::optional<double> paper;
    int n_seeds = 0;  // measured, the fewest of all cells
    Finding finding = Finding::NotMeasured;
    // Why there is no interval, or which runs are missing; "" where there is nothing to say.
    std::string reason;
    // How many more seeds would decide it if mean and spread stay as they are, about; absent where
    // it is decided or more than kMostSeeds would not be enough.
    std::optional<int> more_seeds;
    bool is_paired = false;  // all of its ratios are
    bool has_heavy_tail = false;
    bool few_passes = false;

    // Whether the paper's ratio is within the interval. Absent without either.
    std::optional<bool> agrees_with_paper() const;
};

inline constexpr int kMostSeeds = 1000;

// In the order of the claims, then of their scenes.
std::vector<ClaimFinding> judge_claims(const Store& store, const Plan& plan);

}  // namespace misbench
