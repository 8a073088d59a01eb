#include "results/cell_seeds.h"

#include <cmath>

namespace misbench {

std::optional<double> mean_reference_share(const CellSeeds& cell) {
    double sum = 0;
    int n = 0;
    for (const double share : cell.reference_shares) {
        if (std::isnan(share)) continue;
        sum += share;
        ++n;
    }
    return n > 0 ? std::optional(sum / n) : std::nullopt;
}

}  // namespace misbench
