#include "experiments/resolve.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "experiments/plan/suggestion.h"
#include "experiments/resolve_claims.h"
#include "experiments/scene_lookup.h"
#include "renderer/base/error.h"
#include "renderer/methods/catalogue.h"
#include "results/metrics/metrics.h"

namespace misbench {
namespace {

struct ResolvedScene {
    const SceneEntry* entry;
    SceneListing listing;
    std::string hash;
};

// A label of the experiment, or its reference, with the row of the catalogue behind it.
struct ResolvedMethod {
    std::string label;
    Place place;
    const MethodInfo* info;
    GivenParameters parameters;
};

bool contains(const auto& values, const auto& value) {
    return std::ranges::find(values, value) != values.end();
}

std::vector<std::string> method_names() {
    std::vector<std::string> names;
    for (const MethodInfo& method : methods()) names.emplace_back(method.name);
    return names;
}

std::vector<std::string> parameter_names(const MethodInfo& method) {
    std::vector<std::string> names;
    for (const ParameterInfo& parameter : method.parameters()) names.push_back(parameter.name);
    return names;
}

const MethodInfo& look_up_method(const Placed<std::string>& name) {
    const auto same = [&name](const MethodInfo& method) { return method.name == name.value; };
    const auto method = std::ranges::find_if(methods(), same);
    if (method == methods().end()) {
        fail_at(name.place, unknown_name("method", name.value, method_names()));
    }
    return *method;
}

void require_known_parameters(const MethodInfo& method, const GivenParameters& given) {
    const std::vector<std::string> known = parameter_names(method);
    for (const GivenParameter& parameter : given) {
        if (!contains(known, parameter.name)) {
            fail_at(parameter.name_place,
                    unknown_name("parameter of method '" + std::string(method.name) + "',",
                                 parameter.name, known));
        }
    }
}

std::vector<ResolvedMethod> resolve_methods(const ExperimentYaml& file) {
    std::vector<ResolvedMethod> resolved;
    for (const MethodEntry& entry : file.methods) {
        const MethodInfo& info = look_up_method(entry.method);
        require_known_parameters(info, entry.parameters);
        resolved.push_back({entry.label.value, entry.method.place, &info, entry.parameters});
    }
    return resolved;
}

// A label, whose parameters the reference's own override, or a row of the catalogue.
ResolvedMethod resolve_reference(const ExperimentYaml& file,
                                 const std::vector<ResolvedMethod>& methods) {
    const ReferenceEntry& entry = file.reference;
    ResolvedMethod reference{"reference", entry.method.place, nullptr, {}};
    std::vector<std::string> known = method_names();
    for (const ResolvedMethod& method : methods) {
        known.push_back(method.label);
        if (method.label != entry.method.value) continue;
        reference.info = method.info;
        for (const GivenParameter& parameter : method.parameters) {
            if (!to_map(entry.parameters).contains(parameter.name)) {
                reference.parameters.push_back(parameter);
            }
        }
    }
    if (reference.info == nullptr) {
        if (!contains(known, entry.method.value)) {
            fail_at(entry.method.place, unknown_name("method", entry.method.value, known));
        }
        reference.info = &look_up_method(entry.method);
    }
    require_known_parameters(*reference.info, entry.parameters);
    reference.parameters.insert(reference.parameters.end(), entry.parameters.begin(),
                                entry.parameters.end());
    return reference;
}

void require_scene_parameters_apply(const SceneEntry& scene,
                                    const std::vector<ResolvedMethod>& methods) {
    std::vector<std::string> known;
    for (const ResolvedMethod& method : methods) {
        for (const std::string& name : parameter_names(*method.info)) {
            if (!contains(known, name)) known.push_back(name);
        }
    }
    for (const GivenParameter& parameter : scene.parameters) {
        if (!contains(known, parameter.name)) {
            fail_at(parameter.name_place, unknown_name("parameter", parameter.name, known));
        }
    }
}

std::vector<ResolvedScene> resolve_scenes(const ExperimentYaml& file,
                                          const std::filesystem::path& folder) {
    std::vector<ResolvedScene> resolved;
    for (const SceneEntry& entry : file.scenes) {
        try {
            ResolvedScene scene{&entry,
                                find_scene(entry.scene.value, file.file.parent_path(), folder), ""};
            for (const ResolvedScene& other : resolved) {
                if (other.listing.name == scene.listing.name) {
                    throw Error(Errc::InvalidArgument,
                                "a second scene of the name '" + scene.listing.name + "'");
                }
            }
            scene.hash = scene_content_hash(scene.listing.file);
            resolved.push_back(std::move(scene));
        } catch (const Error& e) {
            fail_at(entry.scene.place, e.what());
        }
    }
    return resolved;
}

// The parameters of a method in a scene, defaults filled in. A wrong value is reported where it
// was written.
ParameterMap effective_parameters(const ResolvedMethod& method, const SceneEntry& scene) {
    const std::vector<std::string> declared = parameter_names(*method.info);
    std::map<std::string, Place> places;
    ParameterMap given;
    for (const GivenParameters& source : {method.parameters, scene.parameters}) {
        for (const GivenParameter& parameter : source) {
            if (!contains(declared, parameter.name)) continue;
            given[parameter.name] = parameter.value;
            places[parameter.name] = parameter.place;
        }
    }
    try {
        return method.info->effective(given);
    } catch (const ParameterError& e) {
        fail_at(places.contains(e.key()) ? places.at(e.key()) : method.place, e.what());
    }
}

Cell make_cell(const ResolvedScene& scene, const ResolvedMethod& method, const Budget& budget,
               std::int64_t seed, Role role) {
    return {.scene = scene.listing.name,
            .method = method.label,
            .budget = budget,
            .seed = seed,
            .role = role,
            .task = {.scene_hash = scene.hash,
                     .width = scene.entry->image.width,
                     .height = scene.entry->image.height,
                     .method = std::string(method.info->name),
                     .method_version = method.info->version,
                     .parameters = effective_parameters(method, *scene.entry),
                     .budget = budget,
                     .seed = seed,
                     .scene = scene.listing.name,
                     .scene_file = scene.listing.file.string()}};
}

// --- include and exclude -------------------------------------------------------------------------

bool axis_matches(const auto& values, const auto& value) {
    const auto same = [&value](const auto& placed) { return placed.value == value; };
    return values.empty() || std::ranges::any_of(values, same);
}

bool matches(const Rule& rule, const Cell& cell) {
    return axis_matches(rule.scenes, cell.scene) && axis_matches(rule.methods, cell.method) &&
           axis_matches(rule.seeds, cell.seed) && axis_matches(rule.budgets, cell.budget);
}

// Every value that a rule names is one of the experiment's.
void require_known_values(const Rule& rule, const Plan& plan, const ExperimentYaml& file) {
    std::vector<std::string> scenes, seeds, budgets;
    for (const PlannedScene& scene : plan.scenes) scenes.push_back(scene.name);
    for (const auto& seed : file.seeds) seeds.push_back(std::to_string(seed.value));
    for (const Budget& budget : plan.budgets) budgets.push_back(to_string(budget));
    const auto require = [](const char* axis, const std::string& name, const Place& place,
                            const std::vector<std::string>& known) {
        if (!contains(known, name)) fail_at(place, unknown_name(axis, name, known));
    };
    for (const auto& scene : rule.scenes) require("scene", scene.value, scene.place, scenes);
    for (const auto& label : rule.methods)
        require("method", label.value, label.place, plan.methods);
    for (const auto& seed : rule.seeds) {
        require("seed", std::to_string(seed.value), seed.place, seeds);
    }
    for (const auto& budget : rule.budgets) {
        require("budget", to_string(budget.value), budget.place, budgets);
    }
}

void apply_rules(const ExperimentYaml& file, Plan& plan) {
    for (const auto* rules : {&file.include, &file.exclude}) {
        for (const Rule& rule : *rules) require_known_values(rule, plan, file);
    }
    std::erase_if(plan.cells, [&file](const Cell& cell) {
        const auto applies = [&cell](const Rule& rule) { return matches(rule, cell); };
        return !file.include.empty() && std::ranges::none_of(file.include, applies);
    });
    for (const Rule& rule : file.exclude) {
        const auto applies = [&rule](const Cell& cell) { return matches(rule, cell); };
        if (std::ranges::none_of(plan.cells, applies)) {
            fail_at(rule.place, "this rule matches no cell");
        }
    }
    std::erase_if(plan.cells, [&file](const Cell& cell) {
        const auto applies = [&cell](const Rule& rule) { return matches(rule, cell); };
        return std::ranges::any_of(file.exclude, applies);
    });
    if (plan.cells.empty()) fail_at(file.exclude.back().place, "no cell is left after this rule");
}

// --- the plan ------------------------------------------------------------------------------------

void require_reference_apart(const ExperimentYaml& file) {
    for (const auto& half : {file.reference.seed_a, file.reference.seed_b}) {
        for (const auto& seed : file.seeds) {
            if (seed.value == half.value) {
                fail_at(half.place, "the reference's seed " + std::to_string(half.value) +
                                        " is also a tested one: its error would be correlated");
            }
        }
    }
}

std::vector<std::string> resolve_metrics(const ExperimentYaml& file) {
    std::vector<std::string> known, resolved;
    for (const Metric& metric : metrics()) known.emplace_back(metric.id);
    for (const auto& metric : file.metrics) {
        if (!contains(known, metric.value)) {
            fail_at(metric.place, unknown_name("metric", metric.value, known));
        }
        if (contains(resolved, metric.value)) {
            fail_at(metric.place, "metric '" + metric.value + "' is listed twice");
        }
        resolved.push_back(metric.value);
    }
    return resolved;
}

std::string resolve_baseline(const ExperimentYaml& file, const Plan& plan) {
    if (!file.baseline) return plan.methods.front();
    if (!contains(plan.methods, file.baseline->value)) {
        fail_at(file.baseline->place, unknown_name("baseline", file.baseline->value, plan.methods));
    }
    return file.baseline->value;
}

// Seeds outermost, so that a stopped experiment still compares all methods.
void add_test_cells(const ExperimentYaml& file, const std::vector<ResolvedScene>& scenes,
                    const std::vector<ResolvedMethod>& methods, Plan& plan) {
    const std::size_t n_cells =
        file.seeds.size() * file.budgets.size() * scenes.size() * methods.size();
    if (n_cells > kMaxCells) {
        throw Error(Errc::InvalidArgument, file.file.string() + ": " + std::to_string(n_cells) +
                                               " cells; known: at most " +
                                               std::to_string(kMaxCells));
    }
    for (const auto& seed : file.seeds) {
        for (const auto& budget : file.budgets) {
            for (const ResolvedScene& scene : scenes) {
                for (const ResolvedMethod& method : methods) {
                    plan.cells.push_back(
                        make_cell(scene, method, budget.value, seed.value, Role::Test));
                    plan.cells.back().task.snapshots = file.snapshots;
                }
            }
        }
    }
}

// Two halves for every scene that has a cell left, in front of everything.
void add_reference_cells(const ReferenceEntry& entry, const std::vector<ResolvedScene>& scenes,
                         const ResolvedMethod& reference, Plan& plan) {
    std::vector<Cell> cells;
    const Budget budget = SampleBudget{entry.samples};
    for (const ResolvedScene& scene : scenes) {
        const auto in_scene = [&scene](const Cell& c) { return c.scene == scene.listing.name; };
        if (std::ranges::none_of(plan.cells, in_scene)) continue;
        cells.push_back(make_cell(scene, reference, budget, entry.seed_a.value, Role::ReferenceA));
        cells.push_back(make_cell(scene, reference, budget, entry.seed_b.value, Role::ReferenceB));
    }
    plan.cells.insert(plan.cells.begin(), cells.begin(), cells.end());
}

nlohmann::json rules_to_json(const std::vector<Rule>& rules) {
    auto json = nlohmann::json::array();
    for (const Rule& rule : rules) {
        nlohmann::json& entry = json.emplace_back(nlohmann::json::object());
        for (const auto& scene : rule.scenes) entry["scene"].push_back(scene.value);
        for (const auto& method : rule.methods) entry["method"].push_back(method.value);
        for (const auto& seed : rule.seeds) entry["seed"].push_back(seed.value);
        for (const auto& budget : rule.budgets) {
            entry["budget"].push_back(budget_to_json(budget.value));
        }
    }
    return json;
}

nlohmann::json method_to_json(const ResolvedMethod& method) {
    const ParameterMap effective = effective_parameters(method, SceneEntry{});
    return {{"method", method.info->name},
            {"version", method.info->version},
            {"parameters", parameters_to_json(effective)}};
}

nlohmann::json scene_to_json(const ResolvedScene& scene) {
    return {{"scene", scene.listing.name},
            {"file", scene.listing.file.string()},
            {"sha256", scene.hash},
            {"image", {{"width", scene.entry->image.width}, {"height", scene.entry->image.height}}},
            {"exposure", scene.entry->exposure},
            {"parameters", parameters_to_json(to_map(scene.entry->parameters))}};
}

// The experiment file as it was understood.
std::string describe(const ExperimentYaml& file, const std::vector<ResolvedScene>& scenes,
                     const std::vector<ResolvedMethod>& methods, const ResolvedMethod& reference,
                     const Plan& plan) {
    nlohmann::json json = {{"name", plan.experiment},
                           {"description", plan.description},
                           {"baseline", plan.baseline},
                           {"metrics", plan.metrics},
                           {"include", rules_to_json(file.include)},
                           {"exclude", rules_to_json(file.exclude)}};
    for (const ResolvedScene& scene : scenes) json["scenes"].push_back(scene_to_json(scene));
    for (const ResolvedMethod& method : methods) {
        json["methods"][method.label] = method_to_json(method);
    }
    if (file.seed_rule) {
        json["seeds"] = seed_rule_to_json(*file.seed_rule);
    } else {
        for (const auto& seed : file.seeds) json["seeds"].push_back(seed.value);
    }
    for (const Budget& budget : plan.budgets) json["budgets"].push_back(budget_to_json(budget));
    if (file.snapshots) {
        json["snapshots"] = {{"first", file.snapshots->first}, {"factor", file.snapshots->factor}};
    }
    json["reference"] = method_to_json(reference);
    json["reference"]["samples"] = file.reference.samples;
    if (!file.profile.name.empty()) json["profile"] = file.profile.name;
    for (const Claim& claim : plan.claims) json["claims"].push_back(claim_to_json(claim));
    json["reference"]["seeds"] = {file.reference.seed_a.value, file.reference.seed_b.value};
    return json.dump();
}

}  // namespace

Plan resolve(const ExperimentYaml& file, const std::filesystem::path& folder) {
    const std::vector<ResolvedMethod> methods = resolve_methods(file);
    const ResolvedMethod reference = resolve_reference(file, methods);
    require_reference_apart(file);

    Plan plan;
    plan.experiment = file.name;
    plan.description = file.description;
    for (const ResolvedMethod& method : methods) plan.methods.push_back(method.label);
    for (const auto& budget : file.budgets) plan.budgets.push_back(budget.value);
    plan.baseline = resolve_baseline(file, plan);
    plan.metrics = resolve_metrics(file);
    plan.seed_rule = file.seed_rule;

    for (const SceneEntry& entry : file.scenes) require_scene_parameters_apply(entry, methods);
    const std::vector<ResolvedScene> scenes = resolve_scenes(file, folder);
    for (const ResolvedScene& scene : scenes) {
        plan.scenes.push_back({.name = scene.listing.name, .exposure = scene.entry->exposure});
    }
    add_test_cells(file, scenes, methods, plan);
    apply_rules(file, plan);
    add_reference_cells(file.reference, scenes, reference, plan);
    plan.claims = resolve_claims(file.claims, plan);
    plan.configuration = describe(file, scenes, methods, reference, plan);
    return plan;
}

}  // namespace misbench
