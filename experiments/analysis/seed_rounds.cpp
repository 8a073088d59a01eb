#include "experiments/analysis/seed_rounds.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "experiments/plan/imported.h"
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

// The ratios that a comparison has of rendered methods, each with its cells, and their baselines.
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
        const bool is_imported = cell.parameters.contains(kImportParameter);
        if (cell.is_baseline || cell.is_mean_of_scenes || is_imported || baseline == nullptr) {
            continue;
        }
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
    std::map<CellKey, int> n_most;
    for (const Cell& cell : largest.cells) n_most[key_of(cell)] += cell.role == Role::Test ? 1 : 0;
    std::map<CellKey, int> n_seeds;
    for (const ComparedCell& cell : comparison.cells) n_seeds[key_of(cell)] = cell.n_planned;
    const auto seeds_of = [&n_seeds](const CellKey& key) { return n_seeds[key]; };
    const std::size_t n_before = with_seeds(largest, seeds_of).cells.size();

    const Ratios ratios = ratios_of(comparison);
    std::vector<const ComparedCell*> open;
    std::vector<RenderedRatio> rendered;
    for (std::size_t r = 0; r < ratios.rendered.size(); ++r) {
        if (!are_complete(ratios, r)) continue;
        open.push_back(ratios.methods[r]);
        rendered.push_back(ratios.rendered[r]);
        rendered.back().most_seeds = n_most[key_of(*open.back())];
    }
    const std::vector<int> n_next =
        allocate(ratios.rendered_baselines, rendered, largest.seed_rule->ratio_halfwidth);
    for (std::size_t i = 0; i < open.size(); ++i) {
        n_seeds[key_of(*open[i])] = n_next[i];
        int& n_baseline = n_seeds[key_of(*ratios.baselines[rendered[i].baseline])];
        n_baseline = std::max(n_baseline, n_next[i]);
    }
    Plan plan = with_seeds(largest, seeds_of);
    if (plan.cells.size() == n_before) return std::nullopt;
    return plan;
}

RuleOutcome outcome_of_rule(const Comparison& comparison) {
    RuleOutcome outcome;
    if (!comparison.seed_rule) return outcome;
    const SeedRule& rule = comparison.seed_rule->rule;
    const Ratios ratios = ratios_of(comparison);
    for (std::size_t r = 0; r < ratios.rendered.size(); ++r) {
        const ComparedCell& cell = *ratios.methods[r];
        const ComparedCell& baseline = *ratios.baselines[ratios.rendered[r].baseline];
        if (is_narrow(ratios.rendered[r].ratio, rule.ratio_halfwidth)) {
            ++outcome.n_narrow;
        } else if (cell.n_unfinished + baseline.n_unfinished > 0) {
            ++outcome.n_open;
        } else if (!are_complete(ratios, r)) {
            ++outcome.n_incomplete;
        } else {
            ++(cell.n_planned < rule.max ? outcome.n_open : outcome.n_at_most);
        }
    }
    return outcome;
}

std::string seed_rule_footnote(const Comparison& comparison) {
    if (!comparison.seed_rule) return "";
    const auto& [rule, metric, baseline, is_of_these] = *comparison.seed_rule;
    std::string line = fmt::format(
        "seeds: {} to {}, until the ratio{} is known within ± {:.3g} %", rule.min, rule.max,
        is_of_these ? "" : " to '" + baseline + "' in " + metric, 100 * rule.ratio_halfwidth);
    if (!is_of_these) return line;
    const RuleOutcome outcome = outcome_of_rule(comparison);
    line += fmt::format(": met by {} of {} ratios", outcome.n_narrow, outcome.n_ratios());
    const char* separator = "; ";
    const auto add = [&](std::size_t n, const std::string& what) {
        if (n == 0) return;
        line += separator + fmt::format("{} {}", n, what);
        separator = ", ";
    };
    add(outcome.n_at_most, fmt::format("stopped at {} seeds", rule.max));
    add(outcome.n_incomplete, "left with failed or invalid runs");
    add(outcome.n_open, "wide with fewer seeds");
    return line;
}

}  // namespace misbench
