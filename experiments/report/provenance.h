// Where the numbers of an experiment come from: machines and builds, as its runs recorded them.
#pragma once

#include <string>
#include <vector>

#include "results/cell_seeds.h"

namespace misbench {

// One line for each, and a warning when there are several.
std::vector<std::string> provenance_lines(const std::vector<Origin>& origins);

}  // namespace misbench
