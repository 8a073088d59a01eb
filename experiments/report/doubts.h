// What a reader of an experiment should doubt, and what ran beside its runs.
#pragma once

#include <string>
#include <vector>

#include "experiments/analysis/comparison.h"
#include "results/store.h"

namespace misbench {

// Above this share of a run's CPU seconds, time that a hypervisor gave to others is a doubt.
inline constexpr double kMuchSteal = 0.01;

// All cases of one kind.
struct Doubt {
    std::string kind;                // "few passes"
    std::vector<std::string> cases;  // one line each, naming scene, method and budget
};
// Kinds without a case are left out. Of the comparison by its metric, and of all runs of the plan.
std::vector<Doubt> doubts(const Store& store, const Plan& plan, const Comparison& comparison);

// What was measured of others on the machine during the tested runs, one line each.
std::vector<std::string> disturbance_lines(const Store& store, const Plan& plan);

}  // namespace misbench
