// Claims as an experiment file makes them, checked against the plan that they are about.
#pragma once

#include <vector>

#include "experiments/plan/claim_entry.h"
#include "experiments/plan/experiment.h"

namespace misbench {

// `plan` is complete but for its claims. Throws InvalidArgument with the place of a name that the
// plan does not know, and of a claim about cells that the plan leaves out.
std::vector<Claim> resolve_claims(const std::vector<ClaimEntry>& entries, const Plan& plan);

}  // namespace misbench
