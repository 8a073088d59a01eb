// The claims of experiments and what was found of them, in the formats people read or paste and in
// those that programs read.
#pragma once

#include <string>
#include <vector>

#include "experiments/analysis/findings.h"

namespace misbench {

// The claims of one experiment; lines of one claim follow each other.
struct ExperimentFindings {
    std::string experiment;
    std::vector<ClaimFinding> findings;
};

std::string claims_to_text(const std::vector<ExperimentFindings>& experiments);
std::string claims_to_markdown(const std::vector<ExperimentFindings>& experiments);
std::string claims_to_html(const ExperimentFindings& experiment);  // a table element and its footer
// One row, or object, for each finding, all numbers in full precision.
std::string claims_to_csv(const std::vector<ExperimentFindings>& experiments);
std::string claims_to_json(const std::vector<ExperimentFindings>& experiments);

}  // namespace misbench
