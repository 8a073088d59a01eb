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

// Of the same scene and method, at other budgets.
std::vector<std::vector<double>> kin_of(const Comparison& comparison, const ComparedCell& cell) {
    std::vector<std::vector<double>> kin;
    for (const ComparedCell& other : comparison.cells) {
        const bool is_kin = other.scene == cell.scene && other.method == cell.method;
        if (is_kin && other.budget != cell.budget) kin.push_back(other.values);
    }
    return kin;
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

struct TestedCell {
    const ComparedCell* cell;
    std::vector<std::vector<double>> kin;
};

// Over the cells and splits of one table.
struct SplitCounts {
    Counts alone;
    Counts adjusted;
    Counts found_alone;
    Counts found_adjusted;
    std::vector<Counts> differ;  // of each cell
    std::vector<Counts> found;
};

// One split of every cell.
void count_split(const std::vector<TestedCell>& cells, std::uint32_t split_idx, double alpha,
                 SplitCounts& counts) {
    std::vector<double> p;
    std::vector<double> planted_p;
    for (std::uint32_t c = 0; c < cells.size(); ++c) {
        Rng rng(0, c, split_idx);
        Halves halves = split(*cells[c].cell, rng);
        for (ComparedCell* half : {&halves.a, &halves.b}) {
            half->tail_verdict = judge_tail(half->values, cells[c].kin);
        }
        p.push_back(p_value_of(halves));
        plant(halves.a);
        planted_p.push_back(p_value_of(halves));
    }
    const std::vector<double> adjusted = benjamini_hochberg(p);
    for (std::size_t c = 0; c < cells.size(); ++c) {
        counts.alone.add(p[c] <= alpha);
        counts.differ[c].add(p[c] <= alpha);
        counts.adjusted.add(adjusted[c] <= alpha);
        counts.found_alone.add(planted_p[c] <= alpha);
        counts.found[c].add(planted_p[c] <= alpha);
        std::vector<double> with_planted = p;
        with_planted[c] = planted_p[c];
        counts.found_adjusted.add(benjamini_hochberg(with_planted)[c] <= alpha);
    }
}

TestedShare tested(const Counts& counts, std::size_t n_cells) {
    const auto n = static_cast<double>(n_cells);
    return {.share = counts.share(), .interval = share_interval(counts.share() * n, n)};
}

SplitCell split_cell(const ComparedCell& cell) {
    const double spread = relative_spread(cell.values);
    return {.scene = cell.scene,
            .method = cell.method,
            .budget = cell.budget,
            .n_seeds = cell.n_measured,
            .power = power_of_ratio(1 + kPlanted, spread, cell.n_measured),
            .n_needed = seeds_for_power(1 + kPlanted, spread, kMostSeedsForPower)};
}

}  // namespace

SelfTest self_test(const Comparison& comparison) {
    SelfTest test{.experiment = comparison.experiment,
                  .metric = comparison.metric,
                  .cells = {},
                  .skipped = {},
                  .alone = {},
                  .adjusted = {}};
    std::vector<TestedCell> cells;
    for (const ComparedCell& cell : comparison.cells) {
        if (cell.n_measured < kFewestToSplit) {
            test.skipped.push_back(fmt::format("{}, {}, {}: {} seed{}", cell.scene, cell.method,
                                               to_string(cell.budget), cell.n_measured,
                                               cell.n_measured == 1 ? "" : "s"));
            continue;
        }
        cells.push_back({&cell, kin_of(comparison, cell)});
        test.cells.push_back(split_cell(cell));
    }
    if (cells.empty()) return test;

    SplitCounts counts;
    counts.differ.resize(cells.size());
    counts.found.resize(cells.size());
    for (std::uint32_t s = 0; s < kSplits; ++s) count_split(cells, s, test.alpha, counts);
    for (std::size_t c = 0; c < cells.size(); ++c) {
        test.cells[c].false_share = counts.differ[c].share();
        test.cells[c].found_share = counts.found[c].share();
    }
    test.alone = tested(counts.alone, cells.size());
    test.adjusted = tested(counts.adjusted, cells.size());
    test.found_alone = counts.found_alone.share();
    test.found_adjusted = counts.found_adjusted.share();
    return test;
}

}  // namespace misbench
