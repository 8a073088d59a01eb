// Resampled importance sampling [TCE05]: of M candidates y_j, drawn with density q, one survives,
// in proportion to its weight p*(y_j) / q(y_j). p* may be any function, not normalised, above 0
// wherever the integrand f is. Then f(y) / p*(y) · Σ_j p*(y_j) / q(y_j) / M estimates the integral
// of f.
//
// [TCE05]  J. Talbot, D. Cline, P. Egbert, Importance resampling for global illumination, 2005.
// [NID20]  K. Nabata, K. Iwasaki, Y. Dobashi, Resampling-aware weighting functions for
//          bidirectional path tracing using multiple light sub-paths, 2020.
#pragma once

#include <utility>

#include "renderer/base/rng.h"

namespace misbench {

// Which of the candidates survives, decided one by one.
class Reservoir {
 public:
    // Whether the next candidate replaces the survivor: always the first, so that there is one also
    // where all weights are 0. Draws a random number only where there is a choice. Its 24 bits keep
    // the wrong one of two with probability 2⁻²⁴ at most, and either stands for the same sum.
    bool keeps(double weight, Rng& rng) {
        const bool any_before = weight_sum_ != 0;
        const bool is_first = std::exchange(is_empty_, false);
        weight_sum_ += weight;
        if (!any_before || weight == 0) return is_first || weight != 0;
        return double{rng.uniform()} * weight_sum_ < weight;
    }
    double weight_sum() const { return weight_sum_; }

 private:
    bool is_empty_ = true;
    double weight_sum_ = 0;
};

// What the density of a survivor is taken for: between the candidates' for one candidate and the
// target's for infinitely many. `normalization` estimates ∫ p*, from other samples than those that
// are weighed. Densities and p* are in one measure, of which the integral is independent.
//                                                                    [NID20, hua2025 Eq. 16]
inline double resampled_density(double candidate_pdf, double target, double normalization,
                                double n_candidates) {
    const double share = 1 / n_candidates;
    return 1 / (share / candidate_pdf + (1 - share) * normalization / target);
}

}  // namespace misbench
