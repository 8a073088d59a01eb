#include "experiments/analysis/seed_rounds.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "experiments/statistics/allocation.h"

namespace misbench {
namespace {

using CellKey = std::tuple<std::string, std::string, std::string>;  // scene, budget, method

CellKey key_of(const auto& cell) { return {cell.scene, to_string(cell.budget), cell.method}; }

// The plan's references, and of each cell as many of its first seeds as `n_seeds` says.
Plan with_seeds(const Plan& largest, const auto& n_seeds) {
    Plan plan = largest;
    plan.cells.clear();
    std::map<CellKey, int> n;
    for (const Cell& cell : largest.cells) {
        const bool is_test = cell.role == Role::Test;
        if (!is_test || n[key_of(cell)]++ < n_seeds(key_of(cell))) plan.cells.push_back(cell);
    }
    return plan;
}

// The ratios that a comparison has, each with its cells, and their baselines.
struct Ratios {
    std::vector<const ComparedCell*> methods;
    std::vector<const ComparedCell*> baselines;
    std::vector<RenderedRatio> rendered;
    std::vector<RenderedBaseline> rendered_baselines;
};

Ratios ratios_of(const Comparison& comparison) {
    Ratios ratios;
    for (const ComparedCell& cell : comparison.cells) {
        const ComparedCell* baseline =
            comparison.find(cell.scene, comparison.baseline, cell.budget);
        if (cell.is_baseline || baseline == nullptr) continue;
        auto known = std::ranges::find(ratios.baselines, baseline);
        if (known == ratios.baselines.end()) {
            ratios.rendered_baselines.push_back(
                {.n = baseline->n_planned, .seconds = baseline->mean_cpu_seconds});
            known = ratios.baselines.insert(known, baseline);
        }
        const auto b = static_cast<std::size_t>(known - ratios.baselines.begin());
        // It has fewer seeds only where a rule of the file excludes some.
        int& n_baseline = ratios.rendered_baselines[b].n;
        n_baseline = std::max(n_baseline, cell.n_planned);
        ratios.rendered.push_back({.baseline = b,
                                   .n = cell.n_planned,
                                   .seconds = cell.mean_cpu_seconds,
                                   .ratio = log_ratio(cell, *baseline)});
        ratios.methods.push_back(&cell);
    }
    return ratios;
}

bool are_complete(const Ratios& ratios, std::size_t r) {
    return ratios.methods[r]->is_complete() &&
           ratios.baselines[ratios.rendered[r].baseline]->is_complete();
}

bool has_unfinished(const Comparison& comparison) {
    return std::ranges::any_of(comparison.cells,
                               [](const ComparedCell& cell) { return cell.n_unfinished > 0; });
}

}  // namespace

Plan first_round(const Plan& largest) {
    if (!largest.seed_rule) return largest;
    return with_seeds(largest, [&](const CellKey&) { return largest.seed_rule->min; });
}

std::optional<Plan> next_round(const Plan& largest, const Comparison& comparison) {
    if (!largest.seed_rule || has_unfinished(comparison)) return std::nullopt;
    Ratios ratios = ratios_of(comparison);
    std::vector<std::size_t> open;
    std::vector<RenderedRatio> rendered;
    for (std::size_t r = 0; r < ratios.rendered.size(); ++r) {
        if (!are_complete(ratios, r)) continue;
        open.push_back(r);
        rendered.push_back(ratios.rendered[r]);
    }
    const std::vector<int> n_next = allocate(
        ratios.rendered_baselines, rendered,
        {.most_seeds = largest.seed_rule->max, .halfwidth = largest.seed_rule->ratio_halfwidth});
    std::map<CellKey, int> n_seeds;
    for (const ComparedCell& cell : comparison.cells) n_seeds[key_of(cell)] = cell.n_planned;
    for (std::size_t i = 0; i < open.size(); ++i) {
        const ComparedCell& method = *ratios.methods[open[i]];
        n_seeds[key_of(method)] = n_next[i];
        int& n_baseline = n_seeds[key_of(*ratios.baselines[rendered[i].baseline])];
        n_baseline = std::max(n_baseline, n_next[i]);
    }
    Plan plan = with_seeds(largest, [&n_seeds](const CellKey& key) { return n_seeds[key]; });
    const auto n_planned = std::ranges::count(plan.cells, Role::Test, &Cell::role);
    std::ptrdiff_t n_before = 0;
    for (const ComparedCell& cell : comparison.cells) n_before += cell.n_planned;
    if (n_planned == n_before) return std::nullopt;
    return plan;
}

RuleOutcome outcome_of_rule(const Comparison& comparison) {
    RuleOutcome outcome;
    if (!comparison.seed_rule) return outcome;
    for (const RenderedRatio& rendered : ratios_of(comparison).rendered) {
        ++outcome.n_ratios;
        if (is_narrow(rendered.ratio, comparison.seed_rule->ratio_halfwidth)) continue;
        ++outcome.n_wide;
        if (rendered.n >= comparison.seed_rule->max) ++outcome.n_at_most;
    }
    return outcome;
}

std::string seed_rule_footnote(const Comparison& comparison) {
    if (!comparison.seed_rule) return "";
    const SeedRule& rule = *comparison.seed_rule;
    const bool is_of_metric = comparison.metric == comparison.rule_metric;
    std::string line = fmt::format(
        "seeds: {} to {}, until the half width of each ratio{} is {:.3g} %", rule.min, rule.max,
        is_of_metric ? "" : " of " + comparison.rule_metric, 100 * rule.ratio_halfwidth);
    if (!is_of_metric) return line;
    const RuleOutcome outcome = outcome_of_rule(comparison);
    line += fmt::format(": {} of {} ratios stopped at {}", outcome.n_at_most, outcome.n_ratios,
                        rule.max);
    const std::size_t n_open = outcome.n_wide - outcome.n_at_most;
    if (n_open > 0) line += fmt::format(", {} wide and not finished", n_open);
    return line;
}

}  // namespace misbench
