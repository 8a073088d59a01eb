// How much of an error against a reference is the reference's own noise.
//
//   R = (r1 + r2)/2           E[((r1 - r2)/2)²] = Var R
//   naive relMSE of I         E[(I - R)²] = Var I + Bias² + Var R
//
// Metrics of halves (metrics.h) are free of Var R, but spread with it: at a large share an interval
// says more of the reference than of the method.
#pragma once

#include "results/metrics/metrics.h"

namespace misbench {

// Above it the reference needs more samples.
inline constexpr double kNoisyReference = 0.05;

// Mean of ((r1 - r2)/2)²/(R² + 0.01) over the mean of (I - R)²/(R² + 0.01); 0 without noise.
// REQUIRES: images of one size.
double reference_share(const Image& image, const ReferencePair& reference);

}  // namespace misbench
