// misbench explain: what a run is made of, and why a task that an experiment asks for is or is not
// taken from the store.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "experiments/cli/output.h"
#include "experiments/cli/run_lookup.h"
#include "experiments/cli/verbs.h"
#include "experiments/plan/imported.h"
#include "experiments/plan/suggestion.h"
#include "experiments/plan/task_difference.h"
#include "experiments/resolve.h"
#include "experiments/scene_lookup.h"
#include "renderer/base/error.h"

namespace misbench {
namespace {

using Rows = std::vector<std::vector<std::string>>;

// --- one run -------------------------------------------------------------------------------------

Rows identity_rows(const Task& task) {
    Rows rows{{"scene content", task.scene_hash},
              {"image size", fmt::format("{}x{}", task.width, task.height)},
              {"method", task.method},
              {"method version", std::to_string(task.method_version)}};
    for (const auto& [key, value] : task.parameters) {
        rows.push_back({"parameter " + key, to_string(value)});
    }
    rows.push_back({"budget", to_string(task.budget)});
    rows.push_back({"seed", std::to_string(task.seed)});
    return rows;
}

Rows record_rows(const Record& record) {
    const Provenance& from = record.provenance;
    Rows rows{{"finished", record.finished_at},
              {"valid", record.valid ? "yes" : "no"},
              {"passes", std::to_string(record.statistics.passes)},
              {"seconds", fmt::format("{:.3g} cpu, {:.3g} wall", record.statistics.cpu_seconds,
                                      record.statistics.wall_seconds)},
              {"image", record.image_sha256}};
    if (is_imported(record.task)) {
        const auto origin =
            nlohmann::json::parse(record.description).value("imported", nlohmann::json::object());
        rows.push_back({"imported from", origin.value("file", "")});
        rows.push_back({"its SHA-256", origin.value("sha256", "")});
        rows.push_back({"renderer", from.build_id});
        return rows;
    }
    rows.push_back({"worker", record.worker});
    rows.push_back({"build", fmt::format("{}, {}", from.build_id, from.compiler)});
    rows.push_back({"machine", fmt::format("{}, {}, {}", from.host, from.cpu_model, from.isa)});
    return rows;
}

// "done", "pending", "failed 3 times: …", "leased by …".
std::string state_of(const TaskRow& row) {
    if (row.state == TaskState::Leased) {
        return fmt::format("leased by {}, epoch {}", row.worker, row.epoch);
    }
    if (row.state == TaskState::Failed) {
        return fmt::format("failed ({} errors, {} leases lost): {}", row.failures, row.losses,
                           row.error);
    }
    return to_string(row.state);
}

Rows use_rows(const Store& store, const std::string& id) {
    Rows rows;
    for (const std::string& name : store.experiments()) {
        const Plan plan = store.experiment(name);
        for (const Cell& cell : plan.cells) {
            if (task_id(cell.task) != id) continue;
            const bool is_test = cell.role == Role::Test;
            rows.push_back(
                {"used by", fmt::format("experiment '{}': {}, {}, {}, seed {}", name, cell.scene,
                                        is_test ? cell.method : to_string(cell.role),
                                        to_string(cell.budget), cell.seed)});
        }
    }
    if (rows.empty()) rows.push_back({"used by", "no experiment"});
    return rows;
}

std::string explain_run(const Store& store, const std::string& id) {
    const std::optional<Record> record = store.run(id);
    const std::optional<TaskRow> row = store.task(id);
    const Task& task = record ? record->task : row->task;
    Rows rows{{"scene", task.scene}};
    if (!task.scene_file.empty()) rows.push_back({"scene file", task.scene_file});
    const auto append = [&rows](const Rows& more) {
        rows.insert(rows.end(), more.begin(), more.end());
    };
    if (!record) rows.push_back({"state", state_of(*row)});
    if (record) append(record_rows(*record));
    append(use_rows(store, id));
    return fmt::format("run {}: reused by every task of this identity\n", id) +
           align(identity_rows(task)) + "\n" + align(rows);
}

// --- the tasks of an experiment ------------------------------------------------------------------

// What is common to seeds that have the same reason.
struct Reason {
    std::string scene;
    std::string method;
    std::string budget;
    std::string why;
    auto operator<=>(const Reason&) const = default;
};
struct Explained {
    std::set<std::int64_t> seeds;
    std::string nearest;  // one of the runs that `why` is about, if any
};

// The runs of a store by what a user would compare a task with.
class StoredTasks {
 public:
    explicit StoredTasks(const Store& store) {
        for (const auto& [id, summary] : store.run_summaries()) {
            const Task task = store.run(id)->task;
            if (!is_imported(task)) tasks_[task.scene].push_back(task);
        }
    }

    // The one of the same scene and method that differs in the fewest fields; one of another method
    // says nothing.
    std::optional<Task> nearest(const Task& task) const {
        const auto there = tasks_.find(task.scene);
        if (there == tasks_.end()) return std::nullopt;
        const Task* best = nullptr;
        std::size_t fewest = 0;
        for (const Task& other : there->second) {
            if (other.method != task.method) continue;
            const std::size_t n = task_differences(task, other).size();
            if (best == nullptr || n < fewest) {
                best = &other;
                fewest = n;
            }
        }
        return best == nullptr ? std::nullopt : std::optional(*best);
    }

 private:
    std::map<std::string, std::vector<Task>> tasks_;  // by the scene's name
};

bool is_of_seed(const TaskDifference& difference) { return difference.field == "seed"; }

std::string why_not(const Store& store, const Task& task, const std::optional<Task>& nearest) {
    std::string why = "not in the store: ";
    if (!nearest) {
        why += "no run of this scene and method";
    } else {
        std::vector<TaskDifference> differences = task_differences(task, *nearest);
        // Any other seed would do as well: that says nothing beside a real difference.
        if (differences.size() > 1) std::erase_if(differences, is_of_seed);
        why += is_of_seed(differences.front())
                   ? "this seed has no run, others have"
                   : "the nearest run differs: " + to_string(differences);
    }
    const std::optional<TaskRow> row = store.task(task_id(task));
    return row ? why + "; task " + state_of(*row) : why + "; no task yet";
}

bool is_asked(const ExplainOptions& options, const Cell& cell) {
    const std::string label = cell.role == Role::Test ? cell.method : "reference";
    return (options.scene.empty() || options.scene == cell.scene) &&
           (options.method.empty() || options.method == label) &&
           (!options.seed || *options.seed == cell.seed);
}

void require_known_names(const ExplainOptions& options, const Plan& plan) {
    std::vector<std::string> scenes;
    std::vector<std::string> labels = plan.methods;
    labels.emplace_back("reference");
    for (const PlannedScene& scene : plan.scenes) scenes.push_back(scene.name);
    const auto require = [](const char* kind, const std::string& name,
                            const std::vector<std::string>& known) {
        if (name.empty() || std::ranges::find(known, name) != known.end()) return;
        throw Error(Errc::InvalidArgument, unknown_name(kind, name, known));
    };
    require("scene", options.scene, scenes);
    require("method", options.method, labels);
}

std::string explain_file(const Store& store, const ExplainOptions& options) {
    const ExperimentOptions& from = options.experiment;
    const Plan plan = resolve(read_experiment_yaml(options.file, from.overrides, from.profile),
                              scene_folder(from.scenes));
    require_known_names(options, plan);
    const StoredTasks stored(store);
    std::map<Reason, Explained> reasons;
    int n_stored = 0;
    int n_tasks = 0;
    for (const Cell& cell : plan.cells) {
        if (!is_asked(options, cell)) continue;
        ++n_tasks;
        const std::optional<Record> record = store.run(task_id(cell.task));
        n_stored += record ? 1 : 0;
        const std::optional<Task> nearest = record ? std::nullopt : stored.nearest(cell.task);
        const std::string why =
            !record ? why_not(store, cell.task, nearest)
                    : std::string("in the store: reused") + (record->valid ? "" : ", but invalid");
        Explained& explained = reasons[{cell.scene, cell.method, to_string(cell.budget), why}];
        explained.seeds.insert(cell.seed);
        if (nearest) explained.nearest = task_id(*nearest);
    }
    std::string text;
    for (const auto& [reason, explained] : reasons) {
        const auto& [seeds, nearest] = explained;
        text +=
            fmt::format("{}, {}, {}, seed{} {}\n  {}{}\n", reason.scene, reason.method,
                        reason.budget, seeds.size() == 1 ? "" : "s", fmt::join(seeds, " "),
                        reason.why, nearest.empty() ? "" : "; such as run " + nearest.substr(0, 8));
    }
    return text +
           fmt::format("{}: {} of {} tasks are in the store\n", plan.experiment, n_stored, n_tasks);
}

}  // namespace

int explain_verb(const ExplainOptions& options) {
    if (options.run.empty() == options.file.empty()) {
        throw Error(Errc::InvalidArgument, "explain: give either a run or --experiment FILE");
    }
    const Store store(options.store, Store::Access::ReadOnly);
    print_result(options.run.empty() ? explain_file(store, options)
                                     : explain_run(store, find_run_or_task(store, options.run)));
    return 0;
}

}  // namespace misbench
