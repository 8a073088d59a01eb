#include "experiments/analysis/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include "renderer/base/error.h"

namespace misbench {
namespace {

// What the store knows of the plan's runs, by run id.
struct Known {
    std::map<std::string, RunSummary> runs;
    std::map<std::string, double> values;
    std::set<std::string> failed;  // tasks
};

Known known_of(const Store& store, const Plan& plan, const std::string& metric) {
    Known known{.runs = store.run_summaries(), .values = {}, .failed = {}};
    if (metric == kSecondsPerPass) {
        for (const auto& [id, run] : known.runs) {
            if (run.passes > 0) {
                known.values[id] = run.cpu_seconds / static_cast<double>(run.passes);
            }
        }
    } else {
        for (const Measurement& m : store.measurements(plan)) {
            if (m.metric == metric) known.values[m.run] = m.value;
        }
    }
    for (const TaskRow& row : store.tasks()) {
        if (row.state == TaskState::Failed) known.failed.insert(row.id);
    }
    return known;
}

// One seed's share. The means are sums until finish().
void count(ComparedCell& cell, const Cell& planned, const Known& known) {
    ++cell.n_planned;
    const std::string id = task_id(planned.task);
    const auto run = known.runs.find(id);
    if (run == known.runs.end()) {
        ++(known.failed.contains(id) ? cell.n_failed : cell.n_unfinished);
        return;
    }
    const RunSummary& summary = run->second;
    cell.few_passes |= has_few_passes(planned.budget, summary.passes);
    if (!summary.valid) {
        ++cell.n_invalid;
        return;
    }
    const auto value = known.values.find(id);
    if (value == known.values.end()) {
        ++cell.n_unreferenced;
        return;
    }
    ++cell.n_measured;
    cell.values.push_back(value->second);
    cell.seeds.push_back(planned.seed);
    cell.mean_passes += static_cast<double>(summary.passes);
    cell.mean_wall_seconds += summary.wall_seconds;
    cell.mean_cpu_seconds += summary.cpu_seconds;
}

std::optional<double> tail_of(std::vector<double> values) {
    if (values.size() < kFewestForInterval) return std::nullopt;
    std::ranges::sort(values);
    const std::size_t middle = values.size() / 2;
    const double median =
        values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
    if (median <= 0) return std::nullopt;
    return values.back() / median;
}

void finish(ComparedCell& cell) {
    if (cell.n_measured > 0) {
        cell.mean_passes /= cell.n_measured;
        cell.mean_wall_seconds /= cell.n_measured;
        cell.mean_cpu_seconds /= cell.n_measured;
    }
    cell.mean = estimate_mean(cell.values);
    cell.tail = tail_of(cell.values);
}

std::vector<Budget> wanted_budgets(const Plan& plan, const std::optional<Budget>& budget) {
    if (!budget) return plan.budgets;
    if (std::ranges::find(plan.budgets, *budget) != plan.budgets.end()) return {*budget};
    std::string known;
    for (const Budget& b : plan.budgets) known.append(" '").append(to_string(b)).append("'");
    throw ParameterError("budget", "experiment '" + plan.experiment + "' has no budget '" +
                                       to_string(*budget) + "'; known:" + known);
}

// What is compared: a metric that the plan measures, or the time of a pass.
struct Quantity {
    std::string id;
    std::string formula;
    Direction better = Direction::Less;
};

Quantity wanted_quantity(const Plan& plan, const std::string& metric) {
    if (metric == kSecondsPerPass)
        return {kSecondsPerPass, "CPU seconds / passes", Direction::Less};
    const bool is_measured = std::ranges::find(plan.metrics, metric) != plan.metrics.end();
    if (is_measured || (metric.empty() && !plan.metrics.empty())) {
        const Metric& found = find_metric(is_measured ? metric : plan.metrics.front());
        return {std::string(found.id), std::string(found.formula), found.better};
    }
    std::string known;
    for (const std::string& m : plan.metrics) known.append(" ").append(m);
    throw ParameterError("metric", "experiment '" + plan.experiment + "' does not measure '" +
                                       metric + "'; known:" + known + " " + kSecondsPerPass);
}

// The values of the seeds that both have.
struct Pairs {
    std::vector<double> a;
    std::vector<double> b;
};

Pairs pairs_of(const ComparedCell& a, const ComparedCell& b) {
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

// The seeds of one cell of the table. Absent where the plan has none.
std::optional<ComparedCell> compared_cell(const Plan& plan, const Known& known,
                                          const std::string& scene, const Budget& budget,
                                          const std::string& method) {
    ComparedCell cell;
    cell.scene = scene;
    cell.method = method;
    cell.budget = budget;
    cell.is_baseline = method == plan.baseline;
    for (const Cell& planned : plan.cells) {
        if (planned.role == Role::Test && planned.scene == scene && planned.method == method &&
            planned.budget == budget) {
            count(cell, planned, known);
        }
    }
    if (cell.n_planned == 0) return std::nullopt;
    finish(cell);
    return cell;
}

}  // namespace

bool are_paired(const ComparedCell& a, const ComparedCell& b) {
    return pairs_of(a, b).a.size() == std::min(a.seeds.size(), b.seeds.size());
}

std::optional<LogRatio> log_ratio(const ComparedCell& a, const ComparedCell& b) {
    if (!are_paired(a, b)) return log_ratio(a.values, b.values);
    const Pairs pairs = pairs_of(a, b);
    return paired_log_ratio(pairs.a, pairs.b);
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
    const Quantity quantity = wanted_quantity(plan, metric);
    Comparison comparison{.experiment = plan.experiment,
                          .metric = quantity.id,
                          .formula = quantity.formula,
                          .better = quantity.better,
                          .baseline = plan.baseline,
                          .scenes = {},
                          .methods = plan.methods,
                          .budgets = wanted_budgets(plan, budget),
                          .cells = {}};
    comparison.seed_rule = plan.seed_rule;
    if (plan.seed_rule) comparison.rule_metric = plan.metrics.front();
    const Known known = known_of(store, plan, comparison.metric);
    for (const PlannedScene& scene : plan.scenes) {
        comparison.scenes.push_back(scene.name);
        for (const Budget& b : comparison.budgets) {
            for (const std::string& method : plan.methods) {
                auto cell = compared_cell(plan, known, scene.name, b, method);
                if (cell) comparison.cells.push_back(std::move(*cell));
            }
        }
    }
    for (ComparedCell& cell : comparison.cells) {
        const ComparedCell* baseline = comparison.find(cell.scene, plan.baseline, cell.budget);
        if (cell.is_baseline || baseline == nullptr) continue;
        const std::optional<LogRatio> ratio = log_ratio(cell, *baseline);
        if (!ratio) continue;
        cell.ratio = to_ratio(*ratio);
        cell.ratio_is_paired = are_paired(cell, *baseline);
    }
    return comparison;
}

}  // namespace misbench
