#include "experiments/analysis/quantity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "renderer/base/error.h"

namespace misbench {
namespace {

constexpr std::string_view kTimesCpu = "*cpu";

struct NamedCost {
    std::string_view name;
    std::string_view formula;
    Direction better;
    RunCost cost;
};
constexpr std::array kCosts{
    NamedCost{kSecondsPerPass, "CPU seconds / passes", Direction::Less, RunCost::SecondsPerPass},
    NamedCost{"passes", "samples a pixel", Direction::None, RunCost::Passes},
    NamedCost{"cpu_seconds", "CPU seconds of a run", Direction::Less, RunCost::CpuSeconds},
    NamedCost{"wall_seconds", "wall seconds of a run", Direction::Less, RunCost::WallSeconds},
    NamedCost{"rays", "rays of a run", Direction::None, RunCost::Rays},
};

std::optional<Quantity> find_known(const Plan& plan, const std::string& text) {
    if (std::ranges::find(plan.metrics, text) != plan.metrics.end()) {
        const Metric& metric = find_metric(text);
        return Quantity{.id = text,
                        .formula = std::string(metric.formula),
                        .better = metric.better,
                        .metric = text};
    }
    for (const NamedCost& row : kCosts) {
        if (row.name == text) {
            return Quantity{.id = text,
                            .formula = std::string(row.formula),
                            .better = row.better,
                            .metric = "",
                            .cost = row.cost};
        }
    }
    return std::nullopt;
}

// "M*cpu" and "1/(M*cpu)" for a metric M of which less is better.
std::optional<Quantity> find_product(const Plan& plan, std::string_view text) {
    const bool is_reciprocal = text.starts_with("1/(") && text.ends_with(")");
    if (is_reciprocal) text = text.substr(3, text.size() - 4);
    if (!text.ends_with(kTimesCpu)) return std::nullopt;
    text.remove_suffix(kTimesCpu.size());
    std::optional<Quantity> found = find_known(plan, std::string(text));
    if (!found || found->metric.empty() || found->better != Direction::Less) return std::nullopt;
    found->cost = RunCost::CpuSeconds;
    found->id += kTimesCpu;
    found->formula = "(" + found->formula + ") × CPU seconds of the run";
    if (is_reciprocal) {
        found->id = "1/(" + found->id + ")";
        found->formula = "1 / mean of " + found->formula;
        found->better = Direction::More;
        found->is_reciprocal = true;
    }
    return found;
}

// "tail(M)" of a metric M.
std::optional<Quantity> find_tail(const Plan& plan, std::string_view text) {
    constexpr std::string_view kBefore = "tail(";
    if (!text.starts_with(kBefore) || !text.ends_with(")")) return std::nullopt;
    text = text.substr(kBefore.size(), text.size() - kBefore.size() - 1);
    std::optional<Quantity> found = find_known(plan, std::string(text));
    if (!found || found->metric.empty()) return std::nullopt;
    found->id = "tail(" + found->id + ")";
    found->formula = "largest / median seed's " + found->formula;
    found->is_tail = true;
    return found;
}

}  // namespace

Quantity find_quantity(const Plan& plan, const std::string& text) {
    const std::string wanted = text.empty() && !plan.metrics.empty() ? plan.metrics.front() : text;
    if (auto found = find_known(plan, wanted)) return *found;
    if (auto found = find_product(plan, wanted)) return *found;
    if (auto found = find_tail(plan, wanted)) return *found;
    std::string known;
    for (const std::string& m : plan.metrics) known.append(" ").append(m);
    for (const NamedCost& row : kCosts) known.append(" ").append(row.name);
    throw ParameterError("metric", "experiment '" + plan.experiment + "' does not measure '" +
                                       text + "'; known:" + known +
                                       ", and METRIC*cpu, 1/(METRIC*cpu) and tail(METRIC)");
}

std::optional<double> value_of(const Quantity& quantity, const CellSeeds& cell, std::size_t seed) {
    double value = 1;
    if (!quantity.metric.empty()) {
        const auto found = cell.values.find(quantity.metric);
        if (found == cell.values.end() || std::isnan(found->second[seed])) return std::nullopt;
        value = found->second[seed];
    }
    switch (quantity.cost) {
        case RunCost::None:
            return value;
        case RunCost::Passes:
            return value * cell.passes[seed];
        case RunCost::CpuSeconds:
            return value * cell.cpu_seconds[seed];
        case RunCost::WallSeconds:
            return value * cell.wall_seconds[seed];
        case RunCost::Rays:
            return value * cell.rays[seed];
        case RunCost::SecondsPerPass:
            break;
    }
    if (cell.passes[seed] == 0) return std::nullopt;
    return value * cell.cpu_seconds[seed] / cell.passes[seed];
}

}  // namespace misbench
