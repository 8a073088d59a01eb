// Ways to weigh the techniques of a problem, as a file asks for them, and as functions.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "experiments/lab/moments.h"

namespace misbench::lab {

// Where moments come from: quadrature, or that many draws of all samples, which are thrown away.
struct MomentsFrom {
    std::optional<int> pilot = {};
};

// hua2025 section 4.1 and appendix A: every combination of these factors, one a technique.
struct CandidateGrid {
    double low = -1;
    double high = 1;
    int candidates = 20;                  // of each technique, both ends among them
    std::vector<std::string> fixed = {};  // techniques that keep the factor 1
    MomentsFrom moments = {};
};

// w_t ∝ β_t u_t: shares u of a heuristic with factors β in front. Where Σ β_t u_t is 0 somewhere,
// the moments are infinite or not numbers, and no search takes such factors.
struct HeuristicWeights {
    std::string heuristic = "balance";
    std::optional<MomentsFrom> variance = {};          // grittmann2019 Eq. 7
    std::optional<MomentsFrom> inverse_variance = {};  // 1 / σ_t²
    bool popov = false;                                // 1 / n_t where samples share a choice
    std::optional<CandidateGrid> correction = {};      // in front of all others
};

// [KVG*19], see renderer/mis/optimal_weights.h. A stratified technique counts as one technique a
// stratum, which the optimum requires (grittmann2019 section 4.3). Samples that share a choice are
// taken as independent: what is optimal for them is unknown.
struct OptimalWeights {
    enum class How { Exact, Direct, Progressive };
    How how = How::Exact;
    int iterations = 1;  // draws of all samples for one estimate; 1 if exact
};

struct OneTechnique {
    std::string technique;
};

struct Weighting {
    std::string name;
    std::variant<HeuristicWeights, OptimalWeights, OneTechnique> kind;
};

// Weights that do not depend on the samples that they weigh.
struct FixedWeights {
    Weigh weigh;
    std::vector<double> factors;  // β_t, one a technique; empty for optimal weights and one alone
};

// Absent for optimal weights that are not exact. Pilots are drawn with the seed. The problem must
// outlive what is returned.
std::optional<FixedWeights> fix_weights(const Problem& problem, const Weighting& weighting,
                                        std::int64_t seed);

// w_t(x) of all techniques; absent where f is 0 and weights mean nothing.
std::optional<std::vector<double>> weights_at(const Problem& problem, const FixedWeights& weights,
                                              double x);

// The run whose iterations are pilots: runs are below it.
inline constexpr std::uint32_t kPilotRun = 0xffffffff;

// A problem's techniques as [KVG*19] sees them, strata apart.
class IndependentTechniques {
 public:
    explicit IndependentTechniques(const Problem& problem);
    const std::vector<double>& counts() const { return counts_; }
    // From the effective densities of the problem's own techniques.
    void densities(double x, std::span<const double> q, std::span<double> apart) const;
    // The one that technique t is at x.
    std::size_t index(std::size_t technique, double x) const;

 private:
    const Problem& problem_;
    std::vector<std::size_t> first_;
    std::vector<double> counts_;
};

}  // namespace misbench::lab
