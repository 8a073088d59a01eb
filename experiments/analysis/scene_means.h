// Ratios over all scenes, as further scenes of a comparison. Two of them, which answer two
// questions with the same number:
//
//   these scenes              what the method does to just them: what is uncertain is each scene's
//                             own ratio, from its seeds (mean_log_ratio)
//   scenes like these         what it does to others that these stand for: what is uncertain is
//                             which scenes were taken (geometric_mean_over_scenes). Has no p value.
//
// Neither has an interval where that of one of its scenes would be dishonest (tail.h).
#pragma once

#include "experiments/analysis/comparison.h"

namespace misbench {

// Adds the geometric means of each method's ratios over the scenes (of each group: what stands
// before the first '/' of a scene's name), where every scene that has the method has a ratio.
// The p values are to be adjusted anew.
void add_means_over_scenes(Comparison& comparison, bool by_group);

}  // namespace misbench
