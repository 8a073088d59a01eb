#include "renderer/paths/path_weights.h"

namespace misbench {

PathWeights::Weight PathWeights::weigh_with_factors(const PathView& path,
                                                    const TechniqueCounts& counts,
                                                    std::span<const double> q, std::size_t s,
                                                    Scratch& scratch) const {
    scratch.factors.assign(q.size(), 1.0);
    for (const auto& provider : providers_) provider->multiply(path, counts, scratch.factors);
    scratch.weighed.assign(q.begin(), q.end());
    for (std::size_t t = 0; t < q.size(); ++t) scratch.weighed[t] *= scratch.factors[t];
    return {.w = scratch.weighed[s] == 0 ? 0 : heuristic_.weight(scratch.weighed, s),
            .q = q,
            .factors = scratch.factors};
}

}  // namespace misbench
