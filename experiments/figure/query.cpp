#include "experiments/figure/query.h"

#include <fmt/format.h>

#include <algorithm>

#include "renderer/base/error.h"

namespace misbench::figure {
namespace {

void require_known(const Placed<std::string>& name, const std::string& what,
                   const std::vector<std::string>& known) {
    if (std::ranges::find(known, name.value) != known.end()) return;
    fail_at(name.place,
            fmt::format("unknown {} '{}'; known: {}", what, name.value, fmt::join(known, " ")));
}

std::vector<Budget> budgets_of(const Plan& plan, const Panel& panel, bool one_budget) {
    std::vector<std::string> known;
    for (const Budget& budget : plan.budgets) {
        known.push_back("'" + to_string(budget) + "'");
        if (to_string(budget) == panel.budget.value) return {budget};
    }
    if (!panel.budget.value.empty()) {
        fail_at(panel.budget.place, fmt::format("unknown budget '{}'; known: {}",
                                                panel.budget.value, fmt::join(known, " ")));
    }
    if (one_budget && plan.budgets.size() != 1) {
        fail_at(panel.place, fmt::format("the experiment has several budgets, of which the panel "
                                         "needs one as 'budget'; known: {}",
                                         fmt::join(known, " ")));
    }
    return plan.budgets;
}

}  // namespace

Query ask(const Store& store, const Panel& panel, bool one_budget, bool with_reference) {
    Query query;
    query.plan = store.experiment(panel.experiment);
    query.budgets = budgets_of(query.plan, panel, one_budget);
    try {
        query.comparison = compare(store, query.plan, panel.metric.value);
    } catch (const ParameterError& e) {
        fail_at(panel.metric.place, e.what());
    }
    std::vector<std::string> scenes;
    for (const PlannedScene& scene : query.plan.scenes) scenes.push_back(scene.name);
    for (const SceneEntry& entry : panel.scenes) require_known(entry.name, "scene", scenes);
    query.scenes = panel.scenes;
    if (query.scenes.empty()) {
        for (const std::string& scene : scenes) {
            query.scenes.push_back({.name = {scene, panel.place}, .exposure = {}, .crops = {}});
        }
    }
    std::vector<std::string> methods = query.plan.methods;
    if (with_reference) methods.insert(methods.begin(), kReference);
    for (const Placed<std::string>& method : panel.methods) {
        require_known(method, "method", methods);
        query.methods.push_back(method.value);
    }
    if (query.methods.empty()) query.methods = methods;
    return query;
}

std::string short_name_of_metric(const std::string& id) {
    const std::string stem = id.substr(0, id.find('.'));
    const std::string trimmed = id.find(".trim") == std::string::npos ? "" : " (trimmed)";
    for (const auto& [lower, usual] :
         {std::pair{"relmse", "relMSE"}, std::pair{"mrse", "MRSE"}, std::pair{"mse", "MSE"},
          std::pair{"flip", "FLIP"}, std::pair{"smape", "SMAPE"}}) {
        if (stem == lower) return usual + trimmed;
    }
    return id;
}

}  // namespace misbench::figure
