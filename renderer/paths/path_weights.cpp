#include "renderer/paths/path_weights.h"

namespace misbench {
namespace {

void multiply(std::span<double> values, std::span<const double> factors) {
    for (std::size_t t = 0; t < values.size(); ++t) values[t] *= factors[t];
}

}  // namespace

void PathWeights::add(std::shared_ptr<const FactorProvider> provider) {
    auto& providers =
        provider->place() == FactorProvider::Place::Densities ? of_densities_ : of_shares_;
    providers.push_back(std::move(provider));
}

PathWeights::Weight PathWeights::weigh(const PathView& path, const TechniqueCounts& counts,
                                       Technique technique, Scratch& scratch) const {
    const std::span<double> q =
        precision_ == DensityPrecision::Double
            ? effective_densities(*path.densities, counts, scratch.in_double)
            : effective_densities(*path.densities, counts, scratch.in_float);
    const auto s = static_cast<std::size_t>(technique.index(path.n_edges()));
    if (q[s] == 0) return {.q = q};

    // h(c ⊙ q), then γ in front of what the heuristic makes of it.       [hua2025 Eq. 17, 18]
    std::vector<double>& u = scratch.weights;
    u.assign(q.begin(), q.end());
    Weight weight{.q = q};
    if (!of_densities_.empty() || !of_shares_.empty()) {
        scratch.factors.assign(q.size(), 1.0);
        weight.factors = scratch.factors;
    }
    if (!of_densities_.empty()) {
        for (const auto& provider : of_densities_) {
            provider->multiply(path, counts, scratch.factors);
        }
        multiply(u, scratch.factors);
        if (u[s] == 0) return weight;
    }
    heuristic_.shares(u);
    if (!of_shares_.empty()) {
        scratch.share_factors.assign(q.size(), 1.0);
        for (const auto& provider : of_shares_) {
            provider->multiply(path, counts, scratch.share_factors);
        }
        multiply(u, scratch.share_factors);
        multiply(scratch.factors, scratch.share_factors);
    }
    double sum = 0;
    for (const double u_t : u) sum += u_t;
    for (double& u_t : u) u_t /= sum;
    weight.w = u[s];
    weight.weights = u;
    return weight;
}

}  // namespace misbench
