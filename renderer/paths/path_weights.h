// The weight of a sample of a full path: a heuristic of the effective densities of all techniques,
// with factors in front of it.
#pragma once

#include <memory>
#include <vector>

#include "renderer/mis/heuristics.h"
#include "renderer/paths/sample.h"

namespace misbench {

// In which type the products of densities are made.
enum class DensityPrecision : std::uint8_t { Double, Float };

class PathWeights {
 public:
    // Of one thread.
    struct Scratch {
        DensityScratch<double> in_double;
        DensityScratch<float> in_float;
        std::vector<double> factors;
        std::vector<double> weighed;
    };
    struct Weight {
        double w = 0;
        std::span<const double> q{};
        std::span<const double> factors{};
    };

    explicit PathWeights(Heuristic heuristic, DensityPrecision precision = DensityPrecision::Double)
        : heuristic_(heuristic), precision_(precision) {}

    // Factors multiply in the order of their addition.
    void add(std::shared_ptr<const FactorProvider> provider) {
        providers_.push_back(std::move(provider));
    }

    // 0 for a technique that cannot have made the path. The spans are valid until the scratch is
    // used again.
    Weight weigh(const PathView& path, const TechniqueCounts& counts, Technique technique,
                 Scratch& scratch) const {
        const std::span<double> q =
            precision_ == DensityPrecision::Double
                ? effective_densities(*path.densities, counts, scratch.in_double)
                : effective_densities(*path.densities, counts, scratch.in_float);
        const auto s = static_cast<std::size_t>(technique.index(path.n_edges()));
        if (!providers_.empty()) return weigh_with_factors(path, counts, q, s, scratch);
        return {.w = q[s] == 0 ? 0 : heuristic_.weight(q, s), .q = q};
    }

 private:
    Weight weigh_with_factors(const PathView& path, const TechniqueCounts& counts,
                              std::span<const double> q, std::size_t s, Scratch& scratch) const;

    Heuristic heuristic_;
    DensityPrecision precision_;
    std::vector<std::shared_ptr<const FactorProvider>> providers_;
};

}  // namespace misbench
