// The colour spaces of FLIP, all with the white of D65 at (1, 1, 1) of linear sRGB.
//
// [And20] P. Andersson et al., FLIP: A Difference Evaluator for Alternating Images, 2020.
// [Hun52] the loss of colourfulness in the dark, after R. Hunt, as [And20] has it.
#pragma once

#include <array>

namespace misbench {

using FlipColor = std::array<float, 3>;

// XYZ over the XYZ of white: a grey has three equal values.
FlipColor xyz_from_linear_rgb(const FlipColor& rgb);
FlipColor linear_rgb_from_xyz(const FlipColor& xyz);

// The linear opponent space in which contrast is filtered: achromatic Y in [0, 100] shifted by -16,
// red to green, blue to yellow.
FlipColor ycxcz_from_xyz(const FlipColor& xyz);
FlipColor xyz_from_ycxcz(const FlipColor& ycxcz);

FlipColor lab_from_xyz(const FlipColor& xyz);
// L* stays; a* and b* are taken times L*/100.                                            [Hun52]
FlipColor hunt_adjusted(const FlipColor& lab);
// City block in lightness, Euclidean in chroma.
float hyab(const FlipColor& a, const FlipColor& b);

}  // namespace misbench
