#include "experiments/analysis/self_test.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "experiments/statistics/multiplicity.h"
#include "experiments/statistics/power.h"
#include "renderer/base/rng.h"

namespace misbench {
namespace {

struct Halves {
    ComparedCell a;
    ComparedCell b;
};

// At random; of an odd number one seed is left out.
Halves split(const ComparedCell& cell, Rng& rng) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < cell.values.size(); ++i) {
        const double place = static_cast<double>(rng.uniform()) * static_cast<double>(i + 1);
        order.insert(order.begin() + static_cast<std::ptrdiff_t>(place), i);
    }
    const std::size_t half = order.size() / 2;
    Halves halves;
    for (std::size_t i = 0; i < 2 * half; ++i) {
        ComparedCell& to = i < half ? halves.a : halves.b;
        to.values.push_back(cell.values[order[i]]);
        to.seeds.push_back(cell.seeds[order[i]]);
    }
    return halves;
}

void plant(ComparedCell& cell) {
    for (double& value : cell.values) value *= 1 + kPlanted;
}

// Of the comparison that tables make. 1 where they show no interval: no difference is found there.
double p_value_of(const Halves& halves) {
    const std::optional<LogRatio> ratio = log_ratio(halves.a, halves.b);
    return ratio && !ratio->why_none ? p_value(*ratio) : 1;
}

struct Counts {
    double n = 0;
    double differ = 0;
    double share() const { return n > 0 ? differ / n : 0; }
    void add(bool differs) {
        n += 1;
        differ += differs ? 1 : 0;
    }
};

TestedShare tested(const Counts& counts, std::size_t n_cells) {
    const auto n = static_cast<double>(n_cells);
    return {.share = counts.share(), .interval = share_interval(counts.share() * n, n)};
}

}  // namespace

SelfTest self_test(const Comparison& comparison) {
    SelfTest test{.experiment = comparison.experiment,
                  .metric = comparison.metric,
                  .cells = {},
                  .skipped = {},
                  .alone = {},
                  .adjusted = {}};
    std::vector<const ComparedCell*> cells;
    for (const ComparedCell& cell : comparison.cells) {
        if (cell.n_measured < kFewestToSplit) {
            test.skipped.push_back(fmt::format("{}, {}, {}: {} seed{}", cell.scene, cell.method,
                                               to_string(cell.budget), cell.n_measured,
                                               cell.n_measured == 1 ? "" : "s"));
            continue;
        }
        cells.push_back(&cell);
        const double spread = relative_spread(cell.values);
        test.cells.push_back(
            {.scene = cell.scene,
             .method = cell.method,
             .budget = cell.budget,
             .n_seeds = cell.n_measured,
             .power = power_of_ratio(1 + kPlanted, spread, cell.n_measured),
             .n_needed = seeds_for_power(1 + kPlanted, spread, kMostSeedsForPower)});
    }
    if (cells.empty()) return test;

    Counts alone;
    Counts adjusted;
    Counts found_alone;
    Counts found_adjusted;
    std::vector<Counts> differ(cells.size());
    std::vector<Counts> found(cells.size());
    for (std::uint32_t s = 0; s < kSplits; ++s) {
        std::vector<double> p;
        std::vector<double> planted_p;
        for (std::uint32_t c = 0; c < cells.size(); ++c) {
            Rng rng(0, c, s);
            Halves halves = split(*cells[c], rng);
            p.push_back(p_value_of(halves));
            plant(halves.a);
            planted_p.push_back(p_value_of(halves));
        }
        const std::vector<double> table = benjamini_hochberg(p);
        for (std::size_t c = 0; c < cells.size(); ++c) {
            alone.add(p[c] <= test.alpha);
            differ[c].add(p[c] <= test.alpha);
            adjusted.add(table[c] <= test.alpha);
            found_alone.add(planted_p[c] <= test.alpha);
            found[c].add(planted_p[c] <= test.alpha);
            std::vector<double> with_planted = p;
            with_planted[c] = planted_p[c];
            found_adjusted.add(benjamini_hochberg(with_planted)[c] <= test.alpha);
        }
    }
    for (std::size_t c = 0; c < cells.size(); ++c) {
        test.cells[c].false_share = differ[c].share();
        test.cells[c].found_share = found[c].share();
    }
    test.alone = tested(alone, cells.size());
    test.adjusted = tested(adjusted, cells.size());
    test.found_alone = found_alone.share();
    test.found_adjusted = found_adjusted.share();
    return test;
}

}  // namespace misbench
