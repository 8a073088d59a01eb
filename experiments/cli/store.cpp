// misbench reindex and misbench status: the store itself.
#include <fmt/format.h>

#include <map>

#include "experiments/cli/output.h"
#include "experiments/cli/verbs.h"
#include "results/store.h"

namespace misbench {

int reindex_verb(const StoreOptions& options) {
    const Reindexed indexed = reindex(options.store);
    for (const std::string& path : indexed.damaged) print_note("set aside as damaged: " + path);
    print_result(fmt::format("{} runs, {} experiments, {} damaged\n", indexed.runs,
                             indexed.experiments, indexed.damaged.size()));
    return 0;
}

int status_verb(const StoreOptions& options) {
    const Store store(options.store, Store::Access::ReadOnly);
    std::map<std::string, TaskState> states;
    for (const TaskRow& row : store.tasks()) states.emplace(row.id, row.state);
    const std::map<std::string, RunSummary> runs = store.run_summaries();

    std::vector<std::vector<std::string>> rows{
        {"experiment", "tasks", "done", "invalid", "running", "pending", "failed"}};
    for (const std::string& name : store.experiments()) {
        std::map<std::string, std::string> tasks;  // id to state, each once
        for (const Cell& cell : store.experiment(name).cells) {
            const std::string id = task_id(cell.task);
            const auto run = runs.find(id);
            const auto state = states.find(id);
            if (run != runs.end()) {
                tasks[id] = run->second.valid ? "done" : "invalid";
            } else {
                tasks[id] = to_string(state == states.end() ? TaskState::Pending : state->second);
            }
        }
        std::map<std::string, int> counts;
        for (const auto& [id, state] : tasks) ++counts[state];
        const int n_done = counts["done"] + counts["invalid"];
        rows.push_back({name, std::to_string(tasks.size()), std::to_string(n_done),
                        std::to_string(counts["invalid"]),
                        std::to_string(counts[to_string(TaskState::Leased)]),
                        std::to_string(counts[to_string(TaskState::Pending)]),
                        std::to_string(counts[to_string(TaskState::Failed)])});
    }
    print_result(align(rows));
    return 0;
}

}  // namespace misbench
