// FLIP: what a person sees who flips between an image and its reference, one value in [0, 1] a
// pixel. Perceptual: the reference's noise is in it, and nothing cancels.
//
// [And20] P. Andersson et al., FLIP: A Difference Evaluator for Alternating Images, 2020.
// [And21] P. Andersson et al., Visualizing Errors in Rendered High Dynamic Range Images, 2021.
#pragma once

#include <vector>

#include "renderer/image/image.h"

namespace misbench {

// A display of 3840 pixels on 0.7 m, seen from 0.7 m away, has 67.02.                     [And20]
inline constexpr double kFlipPixelsPerDegree = 67;

// Row by row. The images are linear light; less than 0 counts as 0.
// REQUIRES: both of one size, not empty, finite.

// As shown on a display: light beyond [0, 1] is clamped.                                  [And20]
std::vector<double> ldr_flip(const Image& image, const Image& reference);

// The largest LDR-FLIP over the exposures that show the reference from its lightest pixel to its
// median one, tone mapped by ACES.                                                        [And21]
std::vector<double> hdr_flip(const Image& image, const Image& reference);

// Stops, from the reference alone: all images of one scene are seen at the same.
std::vector<double> flip_exposures(const Image& reference);

// The filmic curve ACES without its pre-exposure, clamped to [0, 1].                      [And21]
double tone_mapped(double light);

}  // namespace misbench
