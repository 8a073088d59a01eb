#include "experiments/analysis/tradeoff.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "renderer/base/error.h"

namespace misbench {
namespace {

std::string listed(const auto& names) {
    std::string text;
    for (const std::string& name : names) text += " " + name;
    return text;
}

std::string wanted_metric(const Plan& plan, const std::string& name) {
    if (name.empty()) return plan.metrics.front();
    const std::string* found = nullptr;
    for (const std::string& metric : plan.metrics) {
        if (metric == name) return metric;
        const bool begins = metric.starts_with(name + ".");
        if (begins && (found == nullptr || metric.size() < found->size())) found = &metric;
    }
    if (found != nullptr) return *found;
    throw ParameterError("y", "experiment '" + plan.experiment + "' does not measure '" + name +
                                  "'; known:" + listed(plan.metrics));
}

std::vector<std::string> wanted_scenes(const Plan& plan, const std::string& scene) {
    std::vector<std::string> known;
    for (const PlannedScene& planned : plan.scenes) known.push_back(planned.name);
    if (scene.empty()) return known;
    if (std::ranges::find(known, scene) != known.end()) return {scene};
    throw ParameterError("scene", "experiment '" + plan.experiment + "' has no scene '" + scene +
                                      "'; known:" + listed(known));
}

std::string wanted_baseline(const Plan& plan, const std::string& label) {
    if (label.empty()) return plan.baseline;
    if (std::ranges::find(plan.methods, label) != plan.methods.end()) return label;
    throw ParameterError("against", "experiment '" + plan.experiment + "' has no method '" + label +
                                        "'; known:" + listed(plan.methods));
}

double effort_of(const auto& of, Effort effort) {
    if constexpr (requires { of.cpu_seconds; }) {
        return effort == Effort::Cpu    ? of.cpu_seconds
               : effort == Effort::Wall ? of.wall_seconds
                                        : of.passes;
    } else {
        return effort == Effort::Cpu    ? of.mean_cpu_seconds
               : effort == Effort::Wall ? of.mean_wall_seconds
                                        : of.mean_passes;
    }
}

// --- fits ----------------------------------------------------------------------------------------

using Seeds = std::set<std::int64_t>;

Seeds common_seeds(const Curve& curve) {
    Seeds common(curve.points.front().seeds.begin(), curve.points.front().seeds.end());
    for (const CurvePoint& point : curve.points) {
        std::erase_if(common, [&point](std::int64_t seed) {
            return std::ranges::find(point.seeds, seed) == point.seeds.end();
        });
    }
    return common;
}

// Of those seeds, which all points have. Points of one effort are one point: the first.
SeedCurves seed_curves(const Curve& curve, Effort effort, const Seeds& seeds) {
    std::vector<const CurvePoint*> points;
    for (const CurvePoint& point : curve.points) points.push_back(&point);
    const auto at = [effort](const CurvePoint* point) { return effort_of(*point, effort); };
    std::ranges::stable_sort(points, {}, at);
    SeedCurves curves{.efforts = {}, .errors = {}};
    curves.errors.resize(seeds.size());
    for (const CurvePoint* point : points) {
        if (!(at(point) > (curves.efforts.empty() ? 0 : curves.efforts.back()))) continue;
        curves.efforts.push_back(at(point));
        std::size_t i = 0;
        for (const std::int64_t seed : seeds) {
            const auto found = std::ranges::find(point->seeds, seed) - point->seeds.begin();
            curves.errors[i++].push_back(point->values[static_cast<std::size_t>(found)]);
        }
    }
    return curves;
}

std::optional<Crossover> crossover_of(const Curve& a, const Curve& b, Effort effort) {
    const Seeds of_a = common_seeds(a);
    const Seeds of_b = common_seeds(b);
    Seeds both;
    std::ranges::set_intersection(of_a, of_b, std::inserter(both, both.end()));
    if (both.empty()) return std::nullopt;
    return crossover(seed_curves(a, effort, both), seed_curves(b, effort, both));
}

TradeoffMethod method_of(const Curve& curve, Effort effort, const std::optional<double>& target) {
    TradeoffMethod method{.method = curve.method};
    for (const CurvePoint& point : curve.points) {
        method.points.push_back({.effort = effort_of(point, effort), .point = point});
    }
    const Seeds seeds = common_seeds(curve);
    if (seeds.empty()) return method;
    const SeedCurves curves = seed_curves(curve, effort, seeds);
    method.slope = fit_slope(curves);
    method.floor = fit_floor(seed_curves(curve, Effort::Passes, seeds));
    if (target) method.to_target = effort_to_reach(curves, *target, method.floor);
    return method;
}

void mark_front(TradeoffScene& scene) {
    std::vector<CostAndError> points;
    for (const TradeoffMethod& method : scene.methods) {
        for (const TradeoffPoint& p : method.points) {
            points.push_back({p.effort, p.point.mean->value});
        }
    }
    const std::vector<bool> on_front = pareto_front(points);
    std::size_t i = 0;
    for (TradeoffMethod& method : scene.methods) {
        for (TradeoffPoint& p : method.points) p.is_on_front = on_front[i++];
    }
}

TradeoffScene scene_of(const std::string& name, const std::vector<Curve>& curves,
                       const std::string& baseline, Effort effort,
                       const std::optional<double>& target) {
    TradeoffScene scene{.scene = name, .target = target, .methods = {}};
    const auto base = std::ranges::find_if(curves, [&](const Curve& curve) {
        return curve.scene == name && curve.method == baseline;
    });
    if (!target && base != curves.end()) scene.target = base->points.back().mean->value;
    for (const Curve& curve : curves) {
        if (curve.scene != name) continue;
        scene.methods.push_back(method_of(curve, effort, scene.target));
        if (curve.method == baseline || base == curves.end()) continue;
        scene.methods.back().against_baseline = crossover_of(curve, *base, effort);
    }
    mark_front(scene);
    return scene;
}

// --- over all scenes -----------------------------------------------------------------------------

std::optional<OverallTradeoff> overall_of(const Comparison& comparison, const Budget& budget,
                                          const std::string& method, Effort effort,
                                          const std::string& baseline) {
    OverallTradeoff overall{.budget = budget, .method = method};
    std::vector<LogRatio> errors;
    double log_cost = 0;
    for (const std::string& scene : comparison.scenes) {
        const ComparedCell* cell = comparison.find(scene, method, budget);
        const ComparedCell* base = comparison.find(scene, baseline, budget);
        if (cell == nullptr || base == nullptr) continue;
        const std::optional<LogRatio> ratio = log_ratio(*cell, *base);
        if (!ratio) continue;
        errors.push_back(*ratio);
        log_cost += std::log(effort_of(*cell, effort) / effort_of(*base, effort));
    }
    if (errors.empty()) return std::nullopt;
    overall.n_scenes = static_cast<int>(errors.size());
    overall.cost = std::exp(log_cost / overall.n_scenes);
    if (method != baseline) overall.error = to_ratio(mean_log_ratio(errors));
    return overall;
}

std::vector<OverallTradeoff> all_overall(const Comparison& comparison, Effort effort,
                                         const std::string& baseline) {
    std::vector<OverallTradeoff> all;
    for (const Budget& budget : comparison.budgets) {
        std::vector<OverallTradeoff> here;
        std::vector<CostAndError> points;
        for (const std::string& method : comparison.methods) {
            const auto overall = overall_of(comparison, budget, method, effort, baseline);
            if (!overall) continue;
            here.push_back(*overall);
            points.push_back({overall->cost, overall->error.value});
        }
        const std::vector<bool> on_front = pareto_front(points);
        for (std::size_t i = 0; i < here.size(); ++i) here[i].is_on_front = on_front[i];
        all.insert(all.end(), here.begin(), here.end());
    }
    return all;
}

// --- parameters ----------------------------------------------------------------------------------

const Task* task_of(const Plan& plan, const std::string& scene, const std::string& method) {
    const auto cell = std::ranges::find_if(plan.cells, [&](const Cell& c) {
        return c.role == Role::Test && c.scene == scene && c.method == method;
    });
    return cell == plan.cells.end() ? nullptr : &cell->task;
}

std::string without(ParameterMap parameters, const std::string& parameter) {
    parameters.erase(parameter);
    std::string text;
    for (const auto& [name, value] : parameters) text += name + "=" + to_string(value) + " ";
    return text;
}

// Parameters that have two values in labels of one method which are otherwise alike.
std::set<std::string> differing_parameters(const Plan& plan) {
    std::set<std::string> differing;
    for (const PlannedScene& scene : plan.scenes) {
        std::map<std::string, std::set<ParameterValue>> values;
        for (const std::string& label : plan.methods) {
            const Task* task = task_of(plan, scene.name, label);
            if (task == nullptr) continue;
            for (const auto& [name, value] : task->parameters) {
                auto& found =
                    values[task->method + " " + name + " " + without(task->parameters, name)];
                found.insert(value);
                if (found.size() > 1) differing.insert(name);
            }
        }
    }
    return differing;
}

void add_ratio(ParameterStep& step, const ComparedCell& cell, const ComparedCell& before) {
    step.cost_ratio = cell.mean_cpu_seconds / before.mean_cpu_seconds;
    const std::optional<LogRatio> ratio = log_ratio(cell, before);
    if (!ratio) return;
    step.error_ratio = to_ratio(*ratio);
    const auto& interval = step.error_ratio->interval;
    if (interval && interval->high < 1) {
        step.price = (step.cost_ratio - 1) / (1 - step.error_ratio->value);
    }
}

// What tells the ladders of one scene and budget apart: parameters that are not the same in all.
void name_ladders(std::vector<ParameterLadder>& ladders,
                  const std::vector<std::map<std::string, std::string>>& shared) {
    for (std::size_t i = 0; i < ladders.size(); ++i) {
        for (const auto& [name, value] : shared[i]) {
            const bool differs = std::ranges::any_of(shared, [&](const auto& other) {
                const auto found = other.find(name);
                return found == other.end() || found->second != value;
            });
            if (!differs) continue;
            ladders[i].others += (ladders[i].others.empty() ? "" : ", ") + name + " " + value;
        }
    }
}

std::vector<ParameterLadder> ladders_of(const Plan& plan, const Comparison& comparison,
                                        const std::string& scene, const Budget& budget,
                                        const std::string& parameter) {
    struct Rung {
        ParameterValue value;
        const ComparedCell* cell;
    };
    std::map<std::string, std::vector<Rung>> groups;
    std::map<std::string, std::map<std::string, std::string>> shared_of;
    for (const std::string& label : plan.methods) {
        const Task* task = task_of(plan, scene, label);
        const ComparedCell* cell = comparison.find(scene, label, budget);
        if (task == nullptr || cell == nullptr || !cell->mean) continue;
        const auto value = task->parameters.find(parameter);
        if (value == task->parameters.end()) continue;
        const std::string key = task->method + " " + without(task->parameters, parameter);
        groups[key].push_back({value->second, cell});
        auto& shared = shared_of[key];
        shared["method"] = task->method;
        for (const auto& [name, v] : task->parameters) {
            if (name != parameter) shared[name] = to_string(v);
        }
    }
    std::vector<ParameterLadder> ladders;
    std::vector<std::map<std::string, std::string>> shared;
    for (auto& [key, rungs] : groups) {
        if (rungs.size() < 2) continue;
        std::ranges::stable_sort(rungs, {}, &Rung::value);
        ParameterLadder& ladder = ladders.emplace_back();
        ladder.scene = scene;
        ladder.budget = budget;
        for (const auto& [value, cell] : rungs) {
            ParameterStep& step = ladder.steps.emplace_back();
            step.value = to_string(value);
            step.method = cell->method;
            step.error = *cell->mean;
            step.cpu_seconds = cell->mean_cpu_seconds;
            step.seconds_per_pass = cell->mean_cpu_seconds / cell->mean_passes;
            if (cell != rungs.front().cell) {
                add_ratio(step, *cell, *rungs[ladder.steps.size() - 2].cell);
            }
        }
        shared.push_back(shared_of[key]);
    }
    name_ladders(ladders, shared);
    return ladders;
}

}  // namespace

std::string to_string(Effort effort) {
    return effort == Effort::Cpu ? "s cpu" : effort == Effort::Wall ? "s wall" : "spp";
}

Tradeoff tradeoff(const Store& store, const Plan& plan, Effort effort,
                  const TradeoffQuestion& question) {
    Tradeoff result{.experiment = plan.experiment,
                    .metric = wanted_metric(plan, question.metric),
                    .effort = effort,
                    .baseline = wanted_baseline(plan, question.against),
                    .is_target_given = question.target.has_value(),
                    .scenes = {},
                    .overall = {}};
    const std::vector<std::string> scenes = wanted_scenes(plan, question.scene);
    const std::vector<Curve> curves = convergence(store, plan, result.metric);
    for (const std::string& scene : scenes) {
        result.scenes.push_back(scene_of(scene, curves, result.baseline, effort, question.target));
    }
    if (scenes.size() > 1) {
        result.overall = all_overall(compare(store, plan, result.metric), effort, result.baseline);
    }
    return result;
}

ParameterTradeoff parameter_tradeoff(const Store& store, const Plan& plan,
                                     const std::string& parameter,
                                     const TradeoffQuestion& question) {
    const std::set<std::string> known = differing_parameters(plan);
    if (!known.contains(parameter)) {
        throw ParameterError("x", "experiment '" + plan.experiment +
                                      "' has no methods that differ in '" + parameter +
                                      "' alone; known: cost passes wall" + listed(known));
    }
    const std::vector<std::string> scenes = wanted_scenes(plan, question.scene);
    ParameterTradeoff result{.experiment = plan.experiment,
                             .metric = wanted_metric(plan, question.metric),
                             .parameter = parameter,
                             .ladders = {}};
    const Comparison comparison = compare(store, plan, result.metric);
    for (const std::string& scene : scenes) {
        for (const Budget& budget : comparison.budgets) {
            for (ParameterLadder& ladder : ladders_of(plan, comparison, scene, budget, parameter)) {
                result.ladders.push_back(std::move(ladder));
            }
        }
    }
    return result;
}

}  // namespace misbench
