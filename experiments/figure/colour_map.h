// False colours: black, violet, red, orange, yellow, in equal steps of lightness, so that a grey
// copy has the same order and no edge appears that is not in the values.
#pragma once

#include "experiments/figure/drawing.h"

namespace misbench::figure {

// REQUIRES: position within [0, 1].
Colour false_colour(double position);

// Of line plots and crop boxes: Okabe and Ito's six, which most people can tell apart, then the
// same half as strong.
Colour series_colour(std::size_t index);

}  // namespace misbench::figure
