#include "experiments/figure/clear_best.h"

namespace misbench::figure {

std::optional<std::size_t> clear_best(std::span<const ComparedCell> cells, Direction better) {
    if (better == Direction::None) return std::nullopt;
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (!cells[i].mean) continue;
        const bool is_better =
            !best || (better == Direction::Less ? cells[i].mean->value < cells[*best].mean->value
                                                : cells[i].mean->value > cells[*best].mean->value);
        if (is_better) best = i;
    }
    std::size_t n_others = 0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (!best || i == *best || !cells[i].mean) continue;
        const std::optional<LogRatio> ratio = log_ratio(cells[*best], cells[i]);
        if (!ratio || !excludes_one(to_ratio(*ratio))) return std::nullopt;
        ++n_others;
    }
    return n_others > 0 ? best : std::nullopt;
}

}  // namespace misbench::figure
