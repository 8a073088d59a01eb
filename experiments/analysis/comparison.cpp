#include "experiments/analysis/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>
#include <utility>

#include "experiments/analysis/filter.h"
#include "experiments/statistics/bootstrap.h"
#include "experiments/statistics/multiplicity.h"
#include "renderer/base/error.h"

namespace misbench {
namespace {

// What a filter may ask of one seed of a cell.
class SeedFields {
 public:
    SeedFields(const ComparedCell& cell, const CellSeeds& seeds, const Quantity& quantity)
        : cell_(cell), seeds_(seeds), quantity_(quantity) {}

    static std::set<std::string> known(const std::vector<CellSeeds>& cells) {
        std::set<std::string> names{"scene",  "method",  "budget", "seed",
                                    "passes", "seconds", "value"};
        for (const CellSeeds& cell : cells) {
            const auto parameters = parameters_from_json(nlohmann::json::parse(cell.parameters));
            for (const auto& [name, value] : parameters) names.insert(name);
        }
        return names;
    }

    std::optional<ParameterValue> value(const std::string& field, std::size_t seed) const {
        if (field == "scene") return cell_.scene;
        if (field == "method") return cell_.method;
        if (field == "budget") return to_string(cell_.budget);
        if (field == "seed") return seeds_.seeds[seed];
        if (field == "passes" || field == "seconds" || field == "value") {
            return number(field, seed);
        }
        const auto found = cell_.parameters.find(field);
        if (found == cell_.parameters.end()) return std::nullopt;
        return found->second;
    }

 private:
    std::optional<ParameterValue> number(const std::string& field, std::size_t seed) const {
        if (seeds_.state(seed) != SeedState::Valid) return std::nullopt;
        if (field == "passes") return seeds_.passes[seed];
        if (field == "seconds") return seeds_.cpu_seconds[seed];
        const std::optional<double> value = value_of(quantity_, seeds_, seed);
        if (!value) return std::nullopt;
        return quantity_.is_reciprocal ? 1 / *value : *value;
    }

    const ComparedCell& cell_;
    const CellSeeds& seeds_;
    const Quantity& quantity_;
};

// One seed's share. The means are sums until finish().
void count(ComparedCell& cell, const CellSeeds& seeds, std::size_t i, const Quantity& quantity) {
    ++cell.n_planned;
    const SeedState state = seeds.state(i);
    if (state == SeedState::Failed || state == SeedState::Unfinished) {
        ++(state == SeedState::Failed ? cell.n_failed : cell.n_unfinished);
        return;
    }
    cell.few_passes |= has_few_passes(cell.budget, static_cast<std::int64_t>(seeds.passes[i]));
    if (state == SeedState::Invalid) {
        ++cell.n_invalid;
        return;
    }
    const std::optional<double> value = value_of(quantity, seeds, i);
    if (!value) {
        ++cell.n_unreferenced;
        return;
    }
    ++cell.n_measured;
    cell.values.push_back(*value);
    cell.seeds.push_back(seeds.seeds[i]);
    cell.mean_passes += seeds.passes[i];
    cell.mean_wall_seconds += seeds.wall_seconds[i];
    cell.mean_cpu_seconds += seeds.cpu_seconds[i];
}

// Of the reciprocal, if there is one: the mean must be above zero.
std::optional<Estimate> reciprocal(const std::optional<Estimate>& estimate) {
    if (!estimate || estimate->value <= 0) return std::nullopt;
    Estimate result{.value = 1 / estimate->value, .interval = {}, .why_none = estimate->why_none};
    if (estimate->interval && estimate->interval->low > 0) {
        result.interval = Interval{1 / estimate->interval->high, 1 / estimate->interval->low};
    } else if (estimate->interval) {
        result.why_none = NoInterval::Unbounded;
    }
    return result;
}

void finish(ComparedCell& cell, const Quantity& quantity) {
    if (cell.n_measured > 0) {
        cell.mean_passes /= cell.n_measured;
        cell.mean_wall_seconds /= cell.n_measured;
        cell.mean_cpu_seconds /= cell.n_measured;
    }
    cell.mean = estimate_mean(cell.values);
    if (quantity.is_reciprocal) cell.mean = reciprocal(cell.mean);
    cell.tail = max_over_median(cell.values);
    if (!quantity.is_tail) return;
    cell.mean.reset();
    if (cell.tail) cell.mean = Estimate{*cell.tail, std::nullopt, NoInterval::NoEstimate};
}

// The values of each scene and method at all budgets of the plan, whatever is asked for.
class Kin {
 public:
    Kin(const std::vector<CellSeeds>& cells, const Quantity& quantity) {
        for (const CellSeeds& seeds : cells) {
            std::vector<double>& values = values_[{seeds.scene, seeds.method}][seeds.budget];
            for (std::size_t i = 0; i < seeds.seeds.size(); ++i) {
                if (seeds.state(i) != SeedState::Valid) continue;
                if (const auto value = value_of(quantity, seeds, i)) values.push_back(*value);
            }
        }
    }

    std::vector<std::vector<double>> of(const ComparedCell& cell) const {
        std::vector<std::vector<double>> kin;
        for (const auto& [budget, values] : values_.at({cell.scene, cell.method})) {
            if (budget != to_string(cell.budget)) kin.push_back(values);
        }
        return kin;
    }

 private:
    std::map<std::pair<std::string, std::string>, std::map<std::string, std::vector<double>>>
        values_;
};

void judge_tails(Comparison& comparison, const Kin& kin) {
    for (ComparedCell& cell : comparison.cells) {
        cell.tail_verdict = judge_tail(cell.values, kin.of(cell));
        if (cell.tail_verdict != TailVerdict::Dishonest || !cell.mean) continue;
        const bool has_better_reason =
            cell.mean->why_none && cell.mean->why_none != NoInterval::Unbounded;
        if (!has_better_reason) cell.mean = {cell.mean->value, {}, NoInterval::HeavyTail};
    }
}

std::vector<Budget> wanted_budgets(const Plan& plan, const std::optional<Budget>& budget) {
    if (!budget) return plan.budgets;
    if (std::ranges::find(plan.budgets, *budget) != plan.budgets.end()) return {*budget};
    std::string known;
    for (const Budget& b : plan.budgets) known.append(" '").append(to_string(b)).append("'");
    throw ParameterError("budget", "experiment '" + plan.experiment + "' has no budget '" +
                                       to_string(*budget) + "'; known:" + known);
}

std::string wanted_baseline(const Plan& plan, const std::string& ratio_to) {
    if (ratio_to.empty()) return plan.baseline;
    const bool is_known = std::ranges::find(plan.methods, ratio_to) != plan.methods.end();
    if (is_known || ratio_to == kToBest || ratio_to == kToNone) return ratio_to;
    std::string known;
    for (const std::string& m : plan.methods) known.append(" ").append(m);
    throw ParameterError("ratio-to", "experiment '" + plan.experiment + "' has no method '" +
                                         ratio_to + "'; known:" + known + " best none");
}

// The values of the seeds that both have.
struct Pairs {
    std::vector<double> a;
    std::vector<double> b;
};

Pairs pairs_of(const ComparedCell& a, const ComparedCell& b) {
    if (a.seeds == b.seeds) return {a.values, b.values};
    std::map<std::int64_t, double> value_of_b;
    for (std::size_t i = 0; i < b.seeds.size(); ++i) value_of_b[b.seeds[i]] = b.values[i];
    Pairs pairs;
    for (std::size_t i = 0; i < a.seeds.size(); ++i) {
        const auto other = value_of_b.find(a.seeds[i]);
        if (other == value_of_b.end()) continue;
        pairs.a.push_back(a.values[i]);
        pairs.b.push_back(other->second);
    }
    return pairs;
}

// The seeds that the filter lets pass. Absent where there are none.
std::optional<ComparedCell> compared_cell(const CellSeeds& seeds, const Budget& budget,
                                          const Quantity& quantity, const Filter* filter) {
    ComparedCell cell;
    cell.scene = seeds.scene;
    cell.method = seeds.method;
    cell.budget = budget;
    cell.parameters = parameters_from_json(nlohmann::json::parse(seeds.parameters));
    const SeedFields fields(cell, seeds, quantity);
    for (std::size_t i = 0; i < seeds.seeds.size(); ++i) {
        const bool passes = filter == nullptr || filter->matches([&](const std::string& field) {
            return fields.value(field, i);
        });
        if (passes) count(cell, seeds, i, quantity);
    }
    if (cell.n_planned == 0) return std::nullopt;
    finish(cell, quantity);
    if (!quantity.metric.empty()) cell.reference_share = mean_reference_share(seeds);
    return cell;
}

// What a cell's ratio is to. Null for none.
const ComparedCell* baseline_of(const Comparison& comparison, const std::string& scene,
                                const Budget& budget) {
    if (comparison.baseline == kToNone) return nullptr;
    if (comparison.baseline != kToBest) {
        return comparison.find(scene, comparison.baseline, budget);
    }
    const ComparedCell* best = nullptr;
    for (const ComparedCell& cell : comparison.cells) {
        if (cell.scene != scene || cell.budget != budget || !cell.mean) continue;
        const bool is_better = best == nullptr || (comparison.better == Direction::More
                                                       ? cell.mean->value > best->mean->value
                                                       : cell.mean->value < best->mean->value);
        if (is_better) best = &cell;
    }
    return best;
}

void set_ratio(ComparedCell& cell, const LogRatio& ratio) {
    cell.ratio_log = ratio;
    cell.ratio = to_ratio(ratio);
    if (!ratio.why_none || ratio.is_identity) cell.p = p_value(ratio);
}

void compute_ratios(Comparison& comparison, const Quantity& quantity) {
    for (const std::string& scene : comparison.scenes) {
        for (const Budget& budget : comparison.budgets) {
            const ComparedCell* baseline = baseline_of(comparison, scene, budget);
            if (baseline == nullptr) continue;
            for (ComparedCell& cell : comparison.cells) {
                if (cell.scene != scene || cell.budget != budget) continue;
                cell.is_baseline = &cell == baseline;
                if (cell.is_baseline) continue;
                std::optional<LogRatio> ratio = log_ratio(cell, *baseline);
                if (!ratio) continue;
                if (quantity.is_reciprocal) ratio->value = -ratio->value;
                set_ratio(cell, *ratio);
                cell.ratio_is_paired = are_paired(cell, *baseline);
            }
        }
    }
}

// Cells by scene, then budget, then method, as the plan has them.
void order_cells(Comparison& comparison) {
    std::map<std::string, std::size_t> scenes;
    std::map<std::string, std::size_t> methods;
    std::map<std::string, std::size_t> budgets;
    for (const auto& scene : comparison.scenes) scenes.emplace(scene, scenes.size());
    for (const auto& method : comparison.methods) methods.emplace(method, methods.size());
    for (const auto& b : comparison.budgets) budgets.emplace(to_string(b), budgets.size());
    std::ranges::sort(comparison.cells, {}, [&](const ComparedCell& cell) {
        return std::tuple(scenes.at(cell.scene), budgets.at(to_string(cell.budget)),
                          methods.at(cell.method));
    });
}

// What a filter leaves nothing of is no part of the table.
void drop_empty(Comparison& comparison) {
    const auto has_cell = [&comparison](const auto& value, auto member) {
        return std::ranges::any_of(comparison.cells,
                                   [&](const ComparedCell& cell) { return cell.*member == value; });
    };
    std::erase_if(comparison.scenes,
                  [&](const auto& scene) { return !has_cell(scene, &ComparedCell::scene); });
    std::erase_if(comparison.methods,
                  [&](const auto& method) { return !has_cell(method, &ComparedCell::method); });
    std::erase_if(comparison.budgets,
                  [&](const Budget& b) { return !has_cell(b, &ComparedCell::budget); });
}

}  // namespace

bool are_paired(const ComparedCell& a, const ComparedCell& b) {
    return pairs_of(a, b).a.size() == std::min(a.seeds.size(), b.seeds.size());
}

std::optional<LogRatio> log_ratio(const ComparedCell& a, const ComparedCell& b) {
    std::optional<LogRatio> ratio;
    if (are_paired(a, b)) {
        const Pairs pairs = pairs_of(a, b);
        ratio = paired_log_ratio(pairs.a, pairs.b);
    } else {
        ratio = log_ratio(a.values, b.values);
    }
    const bool is_honest =
        a.tail_verdict != TailVerdict::Dishonest && b.tail_verdict != TailVerdict::Dishonest;
    if (ratio && !ratio->why_none && !is_honest) ratio->why_none = NoInterval::HeavyTail;
    return ratio;
}

std::optional<Estimate> bootstrap_ratio(const ComparedCell& a, const ComparedCell& b) {
    if (!are_paired(a, b)) return bootstrap_ratio(a.values, b.values);
    const Pairs pairs = pairs_of(a, b);
    return bootstrap_paired_ratio(pairs.a, pairs.b);
}

std::string status_of(const ComparedCell& cell) {
    if (cell.is_complete()) return "";
    std::string status = fmt::format("{} of {} seeds", cell.n_measured, cell.n_planned);
    const char* separator = ": ";
    const std::array counts{std::pair{cell.n_invalid, "invalid"},
                            std::pair{cell.n_failed, "failed"},
                            std::pair{cell.n_unfinished, "unfinished"},
                            std::pair{cell.n_unreferenced, "without reference"}};
    for (const auto& [count, what] : counts) {
        if (count == 0) continue;
        status += fmt::format("{}{} {}", separator, count, what);
        separator = ", ";
    }
    return status;
}

const ComparedCell* Comparison::find(const std::string& scene, const std::string& method,
                                     const Budget& budget) const {
    const auto found = std::ranges::find_if(cells, [&](const ComparedCell& cell) {
        return cell.scene == scene && cell.method == method && cell.budget == budget;
    });
    return found == cells.end() ? nullptr : &*found;
}

Comparison compare(const Store& store, const Plan& plan, const std::string& metric,
                   const std::optional<Budget>& budget) {
    return compare(store, plan,
                   {.quantity = metric, .budget = budget, .ratio_to = "", .where = ""});
}

Comparison compare(const Store& store, const Plan& plan, const Question& question) {
    const Quantity quantity = find_quantity(plan, question.quantity);
    Comparison comparison{
        .experiment = plan.experiment,
        .metric = quantity.id,
        .formula = quantity.formula,
        .better = quantity.better,
        .baseline = quantity.is_tail ? kToNone : wanted_baseline(plan, question.ratio_to),
        .scenes = {},
        .methods = plan.methods,
        .budgets = wanted_budgets(plan, question.budget),
        .cells = {}};
    if (plan.seed_rule) {
        comparison.seed_rule = {.rule = *plan.seed_rule,
                                .metric = plan.metrics.front(),
                                .baseline = plan.baseline,
                                .is_of_these = comparison.metric == plan.metrics.front() &&
                                               comparison.baseline == plan.baseline &&
                                               question.where.empty()};
    }
    for (const PlannedScene& scene : plan.scenes) comparison.scenes.push_back(scene.name);
    std::map<std::string, Budget> budgets;
    for (const Budget& b : comparison.budgets) budgets.emplace(to_string(b), b);
    std::vector<std::string> metrics;
    if (!quantity.metric.empty()) metrics.push_back(quantity.metric);

    const std::vector<CellSeeds> all = store.cell_seeds(plan.experiment, metrics);
    std::optional<Filter> filter;
    if (!question.where.empty()) filter.emplace(question.where, SeedFields::known(all));
    for (const CellSeeds& seeds : all) {
        const auto b = budgets.find(seeds.budget);
        if (b == budgets.end()) continue;
        auto cell = compared_cell(seeds, b->second, quantity, filter ? &*filter : nullptr);
        if (cell) comparison.cells.push_back(std::move(*cell));
    }
    judge_tails(comparison, Kin(all, quantity));
    order_cells(comparison);
    if (filter) drop_empty(comparison);
    compute_ratios(comparison, quantity);
    if (comparison.baseline != kToBest) adjust_p_values({&comparison, 1});
    return comparison;
}

void adjust_p_values(std::span<Comparison> comparisons) {
    std::vector<ComparedCell*> tested;
    std::vector<double> p;
    for (Comparison& comparison : comparisons) {
        for (ComparedCell& cell : comparison.cells) {
            if (!cell.p) continue;
            tested.push_back(&cell);
            p.push_back(*cell.p);
        }
    }
    const std::vector<double> adjusted = benjamini_hochberg(p);
    for (std::size_t i = 0; i < tested.size(); ++i) tested[i]->adjusted_p = adjusted[i];
}

void store_comparisons(Store& store, const Plan& plan) {
    std::vector<StoredComparison> rows;
    for (const std::string& metric : plan.metrics) {
        const Comparison comparison = compare(store, plan, metric);
        for (const ComparedCell& cell : comparison.cells) {
            if (!cell.ratio) continue;
            StoredComparison& row =
                rows.emplace_back(StoredComparison{.experiment = plan.experiment,
                                                   .metric = metric,
                                                   .baseline = comparison.baseline,
                                                   .scene = cell.scene,
                                                   .method = cell.method,
                                                   .budget = to_string(cell.budget),
                                                   .ratio = cell.ratio->value,
                                                   .low = {},
                                                   .high = {},
                                                   .p = cell.p,
                                                   .adjusted_p = cell.adjusted_p});
            if (!cell.ratio->interval) continue;
            row.low = cell.ratio->interval->low;
            row.high = cell.ratio->interval->high;
        }
    }
    store.put_comparisons(rows);
}

}  // namespace misbench
