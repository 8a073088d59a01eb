// Russian roulette: long paths end at random, by what they still carry.
#pragma once

#include <algorithm>

#include "renderer/base/rng.h"
#include "renderer/math/vec.h"

namespace misbench {

// Survival never rises above this: a path of white walls must end too.
inline constexpr float kMaxSurvival = 0.95F;

// Whether a path of this throughput goes on; beta is then divided by the probability to do so.
inline bool survives(float throughput, Rng& rng, Rgb& beta) {
    const float survival = std::min(kMaxSurvival, throughput);
    if (rng.uniform() >= survival) return false;
    beta = (1 / survival) * beta;
    return true;
}

}  // namespace misbench
