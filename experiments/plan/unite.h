// Two parts of one experiment, such as one rendered here with seeds 1 to 5 and elsewhere with 6 to
// 10, as one plan.
#pragma once

#include <optional>
#include <string>

#include "experiments/plan/experiment.h"

namespace misbench {

// Why these are not parts of one experiment, in words; absent where they are. They are when what
// they share is the same in both: a label's method and parameters in a scene, the scene's content,
// image size, exposure and reference, and the metrics, the baseline, the claims and the
// description. They may differ in which scenes, methods, budgets and seeds they have.
std::optional<std::string> what_differs(const Plan& a, const Plan& b);

// Everything that one of them has, scenes, methods and budgets in the order of `a`, and cells by
// sort_cells(). A seed rule only where both have the same. REQUIRES: !what_differs(a, b).
Plan unite(const Plan& a, const Plan& b);

}  // namespace misbench
