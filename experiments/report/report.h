// The report: one HTML file that needs nothing else, neither network nor a file beside it.
#pragma once

#include <string>

#include "experiments/plan/experiment.h"
#include "results/store.h"

namespace misbench {

// The claims and what was found of them; a table for each metric; for each scene the reference and
// one image per method and budget, all at the scene's exposure; where the numbers come from. The
// same store gives the same bytes.
std::string make_report(const Store& store, const Plan& plan);

}  // namespace misbench
