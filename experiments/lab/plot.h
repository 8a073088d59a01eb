// A study as one SVG: a row a problem, with the integrand and the densities, the weights of each
// weighting, and the errors as bars.
#pragma once

#include <string>
#include <vector>

#include "experiments/lab/study.h"

namespace misbench::lab {

// `outcomes` are of the study's cases.
std::string to_svg(const Study& study, const std::vector<CaseOutcome>& outcomes);

}  // namespace misbench::lab
