// An experiment with a seed rule, round by round: each renders more seeds of the cells whose ratios
// are not narrow yet (experiments/statistics/allocation.h). What comes next follows from the plan
// and the stored runs alone, so an interrupted experiment goes through the same rounds again.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "experiments/analysis/comparison.h"

namespace misbench {

// The part of a plan with all seeds that its rule allows with which it begins; all of it where it
// has no rule.
Plan first_round(const Plan& largest);

// `plan`, which `comparison` in its first metric is of, with the seeds of the next round. Absent
// where there is nothing more to render: no rule, every ratio is narrow or has its most seeds, or
// runs are unfinished. A ratio of a cell with failed or invalid runs is left as it is: what is left
// of its seeds is a selection. Imported images have no further seeds.
std::optional<Plan> next_round(const Plan& largest, const Comparison& comparison);

// What became of the ratios that a rule is about: each is counted once.
struct RuleOutcome {
    std::size_t n_narrow = 0;
    std::size_t n_at_most = 0;     // wide, with the most seeds of the rule
    std::size_t n_incomplete = 0;  // wide, and left as it is for what failed or is invalid
    std::size_t n_open = 0;        // wide, with fewer: not yet rendered, or the file excludes them
    std::size_t n_ratios() const { return n_narrow + n_at_most + n_incomplete + n_open; }
};
RuleOutcome outcome_of_rule(const Comparison& comparison);

// "seeds: 5 to 40, until the ratio is known within ± 10 %: met by 11 of 12 ratios; 1 stopped at 40
// seeds", a line of a footer; "" without a rule.
std::string seed_rule_footnote(const Comparison& comparison);

}  // namespace misbench
