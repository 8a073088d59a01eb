// The weight of a sample of a full path: a heuristic of the effective densities of all techniques,
// with factors in front of it.
#pragma once

#include <memory>
#include <vector>

#include "renderer/mis/heuristics.h"
#include "renderer/paths/factor_provider.h"

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
        std::vector<double> share_factors;
        std::vector<double> weights;
    };
    struct Weight {
        double w = 0;
        std::span<const double> q{};
        std::span<const double> factors{};
        std::span<const double> weights{};  // of all techniques
    };

    explicit PathWeights(Heuristic heuristic, DensityPrecision precision = DensityPrecision::Double)
        : heuristic_(heuristic), precision_(precision) {}

    // Factors of one place multiply in the order of their addition.
    void add(std::shared_ptr<const FactorProvider> provider);

    // 0 for a technique that cannot have made the path; then there are no weights of others. The
    // spans are valid until the scratch is used again.
    Weight weigh(const PathView& path, const TechniqueCounts& counts, Technique technique,
                 Scratch& scratch) const;

 private:
    Heuristic heuristic_;
    DensityPrecision precision_;
    std::vector<std::shared_ptr<const FactorProvider>> of_densities_;
    std::vector<std::shared_ptr<const FactorProvider>> of_shares_;
};

}  // namespace misbench
