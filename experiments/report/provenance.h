// Where the numbers of an experiment come from: machines and builds, as its runs recorded them.
#pragma once

#include <string>
#include <vector>

#include "results/store.h"

namespace misbench {

// That there are several, and which scenes have a single image as both halves of the reference.
std::vector<std::string> provenance_warnings(const Store& store, const std::string& experiment);

// One line for each, then the warnings.
std::vector<std::string> provenance_lines(const Store& store, const std::string& experiment);

}  // namespace misbench
