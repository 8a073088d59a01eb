#include "experiments/plan/experiment.h"

#include <nlohmann/json.hpp>

#include "renderer/base/error.h"

namespace misbench {

std::string to_string(Role role) {
    switch (role) {
        case Role::Test:
            return "test";
        case Role::ReferenceA:
            return "reference_a";
        case Role::ReferenceB:
            break;
    }
    return "reference_b";
}

Role role_from_string(const std::string& text) {
    for (const Role role : {Role::Test, Role::ReferenceA, Role::ReferenceB}) {
        if (to_string(role) == text) return role;
    }
    throw Error(Errc::InvalidArgument,
                "unknown role '" + text + "'; known: test reference_a reference_b");
}

nlohmann::json seed_rule_to_json(const SeedRule& rule) {
    return {{"min", rule.min},
            {"max", rule.max},
            {"until", {{"ratio_halfwidth", rule.ratio_halfwidth}}}};
}

nlohmann::json plan_to_json(const Plan& plan) {
    nlohmann::json json = {{"experiment", plan.experiment}, {"description", plan.description},
                           {"methods", plan.methods},       {"baseline", plan.baseline},
                           {"metrics", plan.metrics},       {"configuration", plan.configuration}};
    auto& scenes = json["scenes"] = nlohmann::json::array();
    for (const PlannedScene& scene : plan.scenes) {
        scenes.push_back({{"name", scene.name}, {"exposure", scene.exposure}});
    }
    auto& budgets = json["budgets"] = nlohmann::json::array();
    for (const Budget& budget : plan.budgets) budgets.push_back(budget_to_json(budget));
    auto& claims = json["claims"] = nlohmann::json::array();
    for (const Claim& claim : plan.claims) claims.push_back(claim_to_json(claim));
    if (plan.seed_rule) json["seed_rule"] = seed_rule_to_json(*plan.seed_rule);
    auto& cells = json["cells"] = nlohmann::json::array();
    for (const Cell& cell : plan.cells) {
        cells.push_back({{"scene", cell.scene},
                         {"method", cell.method},
                         {"budget", budget_to_json(cell.budget)},
                         {"seed", cell.seed},
                         {"role", to_string(cell.role)},
                         {"task", task_to_json(cell.task)}});
    }
    return json;
}

Plan plan_from_json(const nlohmann::json& json) {
    try {
        Plan plan{.experiment = json.at("experiment"),
                  .description = json.at("description"),
                  .scenes = {},
                  .methods = json.at("methods"),
                  .budgets = {},
                  .baseline = json.at("baseline"),
                  .metrics = json.at("metrics"),
                  .claims = {},
                  .cells = {},
                  .configuration = json.at("configuration")};
        for (const auto& scene : json.at("scenes")) {
            plan.scenes.push_back({.name = scene.at("name"), .exposure = scene.at("exposure")});
        }
        for (const auto& budget : json.at("budgets")) {
            plan.budgets.push_back(budget_from_json(budget));
        }
        // Plans of earlier builds have none.
        if (const auto claims = json.find("claims"); claims != json.end()) {
            for (const auto& claim : *claims) plan.claims.push_back(claim_from_json(claim));
        }
        if (const auto rule = json.find("seed_rule"); rule != json.end()) {
            plan.seed_rule = {.min = rule->at("min"),
                              .max = rule->at("max"),
                              .ratio_halfwidth = rule->at("until").at("ratio_halfwidth")};
        }
        for (const auto& cell : json.at("cells")) {
            plan.cells.push_back({.scene = cell.at("scene"),
                                  .method = cell.at("method"),
                                  .budget = budget_from_json(cell.at("budget")),
                                  .seed = cell.at("seed"),
                                  .role = role_from_string(cell.at("role")),
                                  .task = task_from_json(cell.at("task"))});
        }
        return plan;
    } catch (const nlohmann::json::exception& e) {
        throw Error(Errc::InvalidArgument, std::string("plan in JSON: ") + e.what());
    }
}

}  // namespace misbench
