// What accuracy costs: error against effort, from the budgets of an experiment and the snapshots of
// its runs, or error and cost against a parameter in which methods differ.
//
// An effort is the mean over the seeds: intervals are of errors, and of what follows from them, not
// of the clock.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/analysis/convergence.h"
#include "experiments/statistics/convergence_fit.h"

namespace misbench {

enum class Effort { Cpu, Wall, Passes };
std::string to_string(Effort effort);  // "s cpu", "s wall", "spp"

struct TradeoffPoint {
    double effort = 0;
    CurvePoint point;
    bool is_on_front = false;  // no method of the scene has a smaller error at no larger effort
};

struct TradeoffMethod {
    std::string method;  // the user's label
    std::vector<TradeoffPoint> points = {};
    std::optional<Estimate> slope = {};      // over the effort
    std::optional<Estimate> floor = {};      // over the passes
    std::optional<EffortTo> to_target = {};  // absent without a target
    // This one as a, the baseline as b; absent for the baseline, and without common efforts.
    std::optional<Crossover> against_baseline = {};
};

struct TradeoffScene {
    std::string scene;
    std::optional<double> target;  // the one asked for, or the baseline's error at its last effort
    std::vector<TradeoffMethod> methods;  // in the plan's order
};

// Geometric means over the scenes that have both, relative to the baseline at the same budget.
struct OverallTradeoff {
    Budget budget;
    std::string method;
    int n_scenes = 0;
    double cost = 1;  // ratio of the effort
    Estimate error = {.value = 1, .interval = {}, .why_none = {}};
    bool is_on_front = false;  // among those of the budget
};

struct Tradeoff {
    std::string experiment;
    std::string metric;
    Effort effort = Effort::Cpu;
    std::string baseline;
    bool is_target_given = false;  // one for all scenes
    std::vector<TradeoffScene> scenes;
    std::vector<OverallTradeoff> overall;
};

// What is asked for beside the plan; empty: all scenes, the plan's first metric, its baseline.
struct TradeoffQuestion {
    std::string metric = {};  // of the plan: its id, or the shortest that begins so
    std::string scene = {};
    std::string against = {};
    std::optional<double> target = {};
};

// Throws ParameterError, with what is known, for a metric, scene or label that the plan lacks.
Tradeoff tradeoff(const Store& store, const Plan& plan, Effort effort,
                  const TradeoffQuestion& question);

// One value of a parameter: the label that has it.
struct ParameterStep {
    std::string value;
    std::string method;
    Estimate error;
    double cpu_seconds = 0;
    double seconds_per_pass = 0;  // CPU
    // Relative to the step before. Absent for the first and where a mean is not above 0.
    std::optional<Estimate> error_ratio;
    double cost_ratio = 1;
    // Cost in percent of the step before for one percent of its error: above 0 where it is paid
    // for. Absent where the interval of the error's ratio does not say that the error falls.
    std::optional<double> price;
};
// Labels that differ in nothing but the parameter, by its growing value.
struct ParameterLadder {
    std::string scene;
    Budget budget;
    std::string others;  // what they share, as far as other ladders differ in it; "" for one ladder
    std::vector<ParameterStep> steps;  // at least two
};
struct ParameterTradeoff {
    std::string experiment;
    std::string metric;
    std::string parameter;
    std::vector<ParameterLadder> ladders;
};
// Throws ParameterError with the parameters in which labels differ where `parameter` is none.
ParameterTradeoff parameter_tradeoff(const Store& store, const Plan& plan,
                                     const std::string& parameter,
                                     const TradeoffQuestion& question);

}  // namespace misbench
