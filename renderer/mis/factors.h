// Factors in front of a weight, as mathematics: numbers in, numbers out, so that they serve a
// renderer and an integral on [0, 1] alike. Shares u_k are those of heuristics.h; a factor γ_k
// gives the weights γ_s u_s / Σ_k γ_k u_k.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace misbench {

// v_t = μ_{2,t} / σ_t² of a technique alone: its second moment over its variance (grittmann2019 Eq.
// 7). It is >= 1 where both are of the same estimate; where the moment is that of independent
// samples (hua2025 Eq. 11) it is less for samples that are correlated. 1, the balance heuristic,
// where nothing was found or nothing is known, and where either is beyond all numbers.
inline double variance_factor(double second_moment, double variance) {
    const double v = second_moment / variance;
    const bool is_known = second_moment > 0 && variance > 0 && std::isfinite(variance);
    return is_known && std::isfinite(v) ? v : 1;
}

// c_t: how likely the samples of a group that share a prefix are independent, from the probability
// to sample the prefix and the rest again nearby (grittmann2021 Eq. 13 and 15). 1 where both are 0.
inline double correlation_factor(double prefix, double suffix) {
    const double either = prefix + suffix - prefix * suffix;
    return either > 0 ? std::min(1.0, prefix / either) : 1;
}

// w_γ / w of a sample when a factor γ in front of a group of techniques is added to the weight that
// it has: hua2025 Eq. 22. group and others are the sums of the weights of the group's techniques
// and of all others for this path, in_group whether the sample's is one of the group. Exactly 1
// where either sum is 0, so that candidates without a difference tie.
inline double corrected_weight_ratio(double gamma, bool in_group, double group, double others) {
    return (in_group ? gamma : 1) * (group + others) / (gamma * group + others);
}

// The candidate of the least moment: hua2025 section 4.2. Ties, no moments and moments that are not
// finite keep candidate `unchanged`.
inline std::size_t best_candidate(std::span<const double> moments, std::size_t unchanged) {
    std::size_t best = unchanged;
    for (std::size_t c = 0; c < moments.size(); ++c) {
        if (moments[c] < moments[best]) best = c;
    }
    return best;
}

}  // namespace misbench
