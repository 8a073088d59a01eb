// misbench plan: what a run would do.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>

#include "experiments/analysis/seed_rounds.h"
#include "experiments/cli/output.h"
#include "experiments/cli/verbs.h"
#include "experiments/cost_model.h"
#include "experiments/report/numbers.h"
#include "experiments/resolve.h"
#include "experiments/scene_lookup.h"

namespace misbench {
namespace {

struct PlannedTask {
    std::string id;
    const Cell* cell;
    bool is_stored;
    bool is_certain;  // not only for a ratio that fewer seeds leave wide
    Cost cost;
};

struct Totals {
    std::size_t n_tasks = 0;
    std::size_t n_stored = 0;
    double seconds_to_do = 0;
    bool has_guess = false;
};

// Each task once, in the order of work.
std::vector<PlannedTask> tasks_of(const Plan& plan, const Store* store) {
    CostModel costs(store);
    std::vector<PlannedTask> tasks;
    std::set<std::string> seen;
    std::set<std::string> certain;
    for (const Cell& cell : first_round(plan).cells) certain.insert(task_id(cell.task));
    for (const Cell& cell : plan.cells) {
        const std::string id = task_id(cell.task);
        if (!seen.insert(id).second) continue;
        tasks.push_back({id, &cell, store != nullptr && store->has_run(id), certain.contains(id),
                         costs.estimate(cell.task)});
    }
    return tasks;
}

enum class Which { All, Certain };

Totals total(const std::vector<PlannedTask>& tasks, Which which = Which::All) {
    Totals totals;
    for (const PlannedTask& task : tasks) {
        if (which == Which::Certain && !task.is_certain) continue;
        ++totals.n_tasks;
        if (task.is_stored) {
            ++totals.n_stored;
            continue;
        }
        totals.seconds_to_do += task.cost.seconds;
        totals.has_guess |= task.cost.is_guess;
    }
    return totals;
}

std::string to_json(const Plan& plan, const ChosenProfile& profile,
                    const std::vector<PlannedTask>& tasks) {
    const Totals totals = total(tasks);
    nlohmann::ordered_json json = {{"experiment", plan.experiment},
                                   {"profile", profile.name},
                                   {"profiles", profile.known},
                                   {"tasks", tasks.size()},
                                   {"in_store", totals.n_stored},
                                   {"estimated_seconds", totals.seconds_to_do},
                                   {"is_guess", totals.has_guess},
                                   {"configuration", nlohmann::json::parse(plan.configuration)}};
    if (plan.seed_rule) {
        const Totals least = total(tasks, Which::Certain);
        json["least"] = {{"tasks", least.n_tasks},
                         {"in_store", least.n_stored},
                         {"estimated_seconds", least.seconds_to_do},
                         {"is_guess", least.has_guess}};
    }
    json["list"] = nlohmann::ordered_json::array();
    for (const PlannedTask& task : tasks) {
        json["list"].push_back({{"id", task.id},
                                {"role", to_string(task.cell->role)},
                                {"scene", task.cell->scene},
                                {"method", task.cell->method},
                                {"budget", to_string(task.cell->budget)},
                                {"seed", task.cell->seed},
                                {"in_store", task.is_stored},
                                {"is_certain", task.is_certain},
                                {"estimated_seconds", task.cost.seconds},
                                {"is_guess", task.cost.is_guess}});
    }
    return json.dump(2) + "\n";
}

// "profile laptop (known: laptop paper)\n", or "" without profiles.
std::string profile_line(const ChosenProfile& profile) {
    if (profile.known.empty()) return "";
    return fmt::format("profile {} (known: {})\n", profile.name, fmt::join(profile.known, " "));
}

std::string cost_line(const Totals& totals) {
    return fmt::format(
        "{} tasks, {} in the store, {} to do; about {} on one thread{}\n", totals.n_tasks,
        totals.n_stored, totals.n_tasks - totals.n_stored, format_duration(totals.seconds_to_do),
        totals.has_guess ? " (a guess: the store has no run of some scenes and methods)" : "");
}

std::string cost_lines(const Plan& plan, const std::vector<PlannedTask>& tasks) {
    const std::string all = cost_line(total(tasks));
    if (!plan.seed_rule) return plan.experiment + ": " + all;
    const SeedRule& rule = *plan.seed_rule;
    return fmt::format("{}: {} to {} seeds, until the ratio is known within ± {:.3g} %\n",
                       plan.experiment, rule.min, rule.max, 100 * rule.ratio_halfwidth) +
           "  at least: " + cost_line(total(tasks, Which::Certain)) + "  at most:  " + all;
}

std::string to_text(const Plan& plan, const ChosenProfile& profile,
                    const std::vector<PlannedTask>& tasks) {
    std::vector<std::vector<std::string>> rows{
        {"state", "task", "scene", "method", "budget", "seed", "time"}};
    for (const PlannedTask& task : tasks) {
        const char* state = task.is_stored ? "stored" : task.is_certain ? "to do" : "if needed";
        rows.push_back({state, task.id.substr(0, 8), task.cell->scene, task.cell->method,
                        to_string(task.cell->budget), std::to_string(task.cell->seed),
                        task.is_stored ? "" : fmt::format("{:.2g} s", task.cost.seconds)});
    }
    return align(rows) + "\n" + profile_line(profile) + cost_lines(plan, tasks);
}

}  // namespace

int plan_verb(const PlanOptions& options) {
    const ExperimentOptions& from = options.experiment;
    const ExperimentYaml file = read_experiment_yaml(options.file, from.overrides, from.profile);
    const Plan plan = resolve(file, scene_folder(from.scenes));
    std::optional<Store> store;
    if (!options.store.empty() && std::filesystem::exists(options.store)) {
        store.emplace(options.store, Store::Access::ReadOnly);
    }
    const std::vector<PlannedTask> tasks = tasks_of(plan, store ? &*store : nullptr);
    print_result(options.json ? to_json(plan, file.profile, tasks)
                              : to_text(plan, file.profile, tasks));
    return 0;
}

}  // namespace misbench
