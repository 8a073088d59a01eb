#include "experiments/figure/clear_best.h"

#include <algorithm>

#include "experiments/statistics/multiplicity.h"

namespace misbench::figure {
namespace {

struct Best {
    std::size_t index = 0;
    double p = 1;
};

double p_against(const ComparedCell& best, const ComparedCell& other) {
    const std::optional<LogRatio> ratio = log_ratio(best, other);
    return ratio && !ratio->why_none ? p_value(*ratio) : 1;
}

std::optional<Best> best_of(const std::vector<ComparedCell>& cells, Direction better) {
    std::optional<Best> best;
    std::size_t n_measured = 0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (!cells[i].mean) continue;
        ++n_measured;
        const double value = cells[i].mean->value;
        const double least = best ? cells[best->index].mean->value : value;
        if (!best || (better == Direction::Less ? value < least : value > least)) best = Best{i};
    }
    if (n_measured < 2) return std::nullopt;
    best->p = 0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (i == best->index || !cells[i].mean) continue;
        best->p = std::max(best->p, p_against(cells[best->index], cells[i]));
    }
    return best;
}

}  // namespace

std::vector<std::optional<std::size_t>> clear_bests(std::span<const std::vector<ComparedCell>> rows,
                                                    Direction better) {
    std::vector<std::optional<std::size_t>> bests(rows.size());
    if (better == Direction::None) return bests;
    std::vector<std::size_t> tested;  // rows
    std::vector<double> p;
    for (std::size_t r = 0; r < rows.size(); ++r) {
        if (const std::optional<Best> best = best_of(rows[r], better)) {
            bests[r] = best->index;
            tested.push_back(r);
            p.push_back(best->p);
        }
    }
    const std::vector<double> adjusted = benjamini_hochberg(p);
    for (std::size_t i = 0; i < tested.size(); ++i) {
        if (adjusted[i] > 1 - kConfidence) bests[tested[i]].reset();
    }
    return bests;
}

}  // namespace misbench::figure
