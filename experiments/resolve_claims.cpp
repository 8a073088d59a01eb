#include "experiments/resolve_claims.h"

#include <algorithm>

#include "experiments/plan/suggestion.h"

namespace misbench {
namespace {

std::string known_one(const std::string& kind, const Placed<std::string>& name,
                      const std::vector<std::string>& known) {
    if (std::ranges::find(known, name.value) == known.end()) {
        fail_at(name.place, unknown_name(kind, name.value, known));
    }
    return name.value;
}

constexpr std::string_view kImported = "imported:";

// A label of the plan, or of images that are imported beside it: imported:LABEL.
std::string resolve_method(const Placed<std::string>& name, const Plan& plan) {
    if (!name.value.starts_with(kImported)) return known_one("method", name, plan.methods);
    std::string label = name.value.substr(kImported.size());
    if (std::ranges::find(plan.methods, label) != plan.methods.end()) {
        fail_at(name.place, "'" + label + "' is a method of this file, not one of imported images");
    }
    return label;
}

std::string resolve_metric(const ClaimEntry& entry, const Plan& plan) {
    if (!entry.metric) return plan.metrics.front();
    std::vector<std::string> known = plan.metrics;
    known.emplace_back(kSecondsPerPass);
    return known_one("metric of the experiment,", *entry.metric, known);
}

Budget resolve_budget(const ClaimEntry& entry, const Plan& plan) {
    if (!entry.budget) return plan.budgets.front();
    std::vector<std::string> known;
    for (const Budget& budget : plan.budgets) known.push_back(to_string(budget));
    known_one("budget", {to_string(entry.budget->value), entry.budget->place}, known);
    return entry.budget->value;
}

bool has_cell(const Plan& plan, const std::string& scene, const std::string& method,
              const Budget& budget) {
    return std::ranges::any_of(plan.cells, [&](const Cell& cell) {
        return cell.role == Role::Test && cell.scene == scene && cell.method == method &&
               cell.budget == budget;
    });
}

// Those named, which must have both methods, or all that have both. Which of them imported images
// will have nobody knows yet.
std::vector<std::string> resolve_scenes(const ClaimEntry& entry, const Claim& claim,
                                        const Plan& plan) {
    std::vector<std::string> known;
    std::vector<std::string> scenes;
    const auto lacks = [&](const std::string& scene, const std::string& method) {
        const bool is_rendered = std::ranges::find(plan.methods, method) != plan.methods.end();
        return is_rendered && !has_cell(plan, scene, method, claim.budget);
    };
    for (const PlannedScene& scene : plan.scenes) {
        known.push_back(scene.name);
        if (lacks(scene.name, claim.method) || lacks(scene.name, claim.against)) continue;
        if (entry.scenes.empty()) scenes.push_back(scene.name);
    }
    for (const Placed<std::string>& scene : entry.scenes) {
        known_one("scene", scene, known);
        for (const std::string& method : {claim.method, claim.against}) {
            if (!lacks(scene.value, method)) continue;
            fail_at(scene.place, "the experiment leaves out '" + method + "' in scene '" +
                                     scene.value + "' with " + to_string(claim.budget));
        }
        if (std::ranges::find(scenes, scene.value) != scenes.end()) {
            fail_at(scene.place, "scene '" + scene.value + "' is listed twice");
        }
        scenes.push_back(scene.value);
    }
    if (scenes.empty()) {
        fail_at(entry.place, "the experiment has no scene with both '" + claim.method + "' and '" +
                                 claim.against + "' with " + to_string(claim.budget));
    }
    return scenes;
}

std::map<std::string, double> resolve_paper(const ClaimEntry& entry, const Claim& claim) {
    std::map<std::string, double> paper;
    for (const PaperEntry& number : entry.paper) {
        if (!number.scene.value.empty()) {
            paper[known_one("scene of the claim,", number.scene, claim.scenes)] = number.ratio;
        } else if (claim.over == ClaimOver::Each) {
            for (const std::string& scene : claim.scenes) paper[scene] = number.ratio;
        } else {
            paper[""] = number.ratio;
        }
    }
    return paper;
}

Claim resolve_claim(const ClaimEntry& entry, const Plan& plan) {
    Claim claim{.text = entry.text,
                .where = entry.where,
                .scenes = {},
                .method = resolve_method(entry.method, plan),
                .against = plan.baseline,
                .metric = resolve_metric(entry, plan),
                .budget = resolve_budget(entry, plan),
                .over = entry.over,
                .expect = entry.expect,
                .margin = entry.margin,
                .note = entry.note};
    if (entry.against) claim.against = resolve_method(*entry.against, plan);
    if (claim.method == claim.against) {
        fail_at(entry.against ? entry.against->place : entry.method.place,
                "a claim compares '" + claim.method + "' with itself");
    }
    claim.scenes = resolve_scenes(entry, claim, plan);
    claim.paper = resolve_paper(entry, claim);
    return claim;
}

}  // namespace

std::vector<Claim> resolve_claims(const std::vector<ClaimEntry>& entries, const Plan& plan) {
    std::vector<Claim> claims;
    for (const ClaimEntry& entry : entries) claims.push_back(resolve_claim(entry, plan));
    return claims;
}

}  // namespace misbench
