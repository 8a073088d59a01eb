// Which numbers of a figure may be printed in bold.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "experiments/analysis/comparison.h"

namespace misbench::figure {

// For each row of cells that are compared with each other, the one with the best mean, if it
// differs from each other cell of its row; absent where it does not, and where fewer than two are
// measured. A row's p is the largest of those of the best against another, which needs no
// correction for their number [GM87]; those of all rows together are adjusted by Benjamini and
// Hochberg, as a table's.
//
// [GM87] S. Gutmann, Z. Maymin, Is the Selected Population the Best?, The Annals of Statistics
//        15(1), 1987.
std::vector<std::optional<std::size_t>> clear_bests(std::span<const std::vector<ComparedCell>> rows,
                                                    Direction better);

}  // namespace misbench::figure
