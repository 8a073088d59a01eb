// Where to look: the parts of an image in which two methods differ most.
#pragma once

#include <vector>

#include "experiments/figure/raster.h"

namespace misbench::figure {

// Windows of one size, at most `count`, the one with the largest difference first: the
// sum of |a - b| over its pixels, where each is the median of 5×5, so that no firefly decides. Of
// equal windows the upper left one. Windows keep half of
// their size away from each other; where no room is left there are fewer.
// REQUIRES: both maps of one size, in which the window fits.
std::vector<Window> auto_crops(const ValueMap& a, const ValueMap& b, int width, int height,
                               int count);

}  // namespace misbench::figure
