// Where the numbers of an experiment come from: machines and builds, as its runs recorded them.
#pragma once

#include <string>
#include <vector>

#include "results/store.h"

namespace misbench {

// One line for each, a warning when there are several, and which scenes have a single image as both
// halves of the reference.
std::vector<std::string> provenance_lines(const Store& store, const std::string& experiment);

}  // namespace misbench
