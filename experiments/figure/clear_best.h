// Which number of a row may be printed in bold.
#pragma once

#include <optional>
#include <span>

#include "experiments/analysis/comparison.h"

namespace misbench::figure {

// The cell with the best mean, where the 95 % interval of its ratio to each other excludes one;
// absent where it does not, and where fewer than two are measured.
std::optional<std::size_t> clear_best(std::span<const ComparedCell> cells, Direction better);

}  // namespace misbench::figure
