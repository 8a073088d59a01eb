// The rows of experiments, cells, tasks and runs: SQL in, values out. Files are not its business.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "results/run_directory.h"
#include "results/sqlite.h"
#include "results/store.h"

namespace misbench {

// The halves of the reference that a cell is compared with.
struct ReferenceIds {
    std::string a;
    std::string b;
    bool operator==(const ReferenceIds&) const = default;
};

// For each cell of the plan: set for the tests whose scene and image size have both halves.
std::vector<std::optional<ReferenceIds>> references_of(const Plan& plan);

// In one transaction. Idempotent.
void insert_experiment(const Database& database, const ExperimentFile& file);
void delete_experiment(const Database& database, const std::string& name);

std::vector<TaskRow> select_tasks(const Database& database);
std::optional<TaskRow> select_task(const Database& database, const std::string& id);
void update_task_state(const Database& database, const TaskRow& row);
std::int64_t take_epoch(const Database& database);

// The run's row, and Done for its task, in one transaction. A run that is there stays.
Recorded insert_run(const Database& database, const Record& record);

}  // namespace misbench
