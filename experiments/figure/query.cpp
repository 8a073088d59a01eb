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

}  // namespace

Query ask(const Store& store, const Panel& panel, bool with_reference) {
    Query query;
    query.plan = store.experiment(panel.experiment);
    try {
        query.comparison = compare(store, query.plan, panel.metric.value);
    } catch (const ParameterError& e) {
        fail_at(panel.metric.value.empty() ? panel.place : panel.metric.place, e.what());
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
    std::vector<std::string> titled = scenes;
    titled.insert(titled.end(), query.plan.methods.begin(), query.plan.methods.end());
    titled.emplace_back(kReference);
    if (const auto* sweep = std::get_if<SweepPanel>(&panel.kind)) {
        titled.push_back(sweep->parameter.value);
    }
    require_titles_of(panel, titled);
    return query;
}

void require_titles_of(const Panel& panel, const std::vector<std::string>& known) {
    for (const auto& [name, title] : panel.titles) {
        require_known({name, title.place}, "name in titles", known);
    }
}

Budget budget_of(const Query& query, const Panel& panel) {
    std::vector<std::string> known;
    for (const Budget& budget : query.plan.budgets) {
        known.push_back("'" + to_string(budget) + "'");
        if (to_string(budget) == panel.budget.value) return budget;
    }
    if (!panel.budget.value.empty()) {
        fail_at(panel.budget.place, fmt::format("unknown budget '{}'; known: {}",
                                                panel.budget.value, fmt::join(known, " ")));
    }
    if (known.size() != 1) {
        fail_at(panel.place, fmt::format("the experiment has several budgets, of which the panel "
                                         "needs one as 'budget'; known: {}",
                                         fmt::join(known, " ")));
    }
    return query.plan.budgets.front();
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
