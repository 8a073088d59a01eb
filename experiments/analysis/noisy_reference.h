// Which cells of an experiment are compared with a reference that is too noisy for them, and the
// same experiment with a better one.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "experiments/plan/experiment.h"
#include "results/reference_noise.h"
#include "results/store.h"

namespace misbench {

// Mean over the measured seeds of a cell.
struct CellReferenceShare {
    std::string scene;
    std::string method;  // the user's label
    Budget budget;
    double share = 0;  // results/reference_noise.h
    bool is_noisy() const { return share > kNoisyReference; }
};
// In the order of the plan; cells without a measured seed are left out.
std::vector<CellReferenceShare> cell_reference_shares(const Store& store, const Plan& plan);

// With `factor` times the samples in the halves of these scenes' references. Their seeds stay, so
// the samples that are there are among the new ones. Throws InvalidArgument for a reference that
// has no number of samples, or that was imported.
Plan with_better_references(Plan plan, const std::set<std::string>& scenes, std::int64_t factor);

// The halves of these scenes' references, as an experiment that exists while they are rendered.
Plan references_alone(const Plan& plan, const std::set<std::string>& scenes);

}  // namespace misbench
