#include "results/job_table.h"

#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "renderer/base/check.h"
#include "renderer/base/error.h"

namespace misbench {
namespace {

constexpr std::array kStates = {TaskState::Pending, TaskState::Leased, TaskState::Done,
                                TaskState::Failed};

TaskState task_state_from_string(const std::string& text) {
    for (const TaskState state : kStates) {
        if (to_string(state) == text) return state;
    }
    throw Error(Errc::DataLoss, "read the job table: unknown task state '" + text + "'");
}

// Tasks that share a scene's content, its image size and a seed: a worker that has the scene in
// memory goes on with it, and methods are compared on one machine.
std::string block_of(const Cell& cell) {
    const Task& task = cell.task;
    std::string block = task.scene_hash.substr(0, 16) + "/" + std::to_string(task.width) + "x" +
                        std::to_string(task.height) + "/" + std::to_string(task.seed);
    if (cell.role != Role::Test) block.append("/").append(to_string(cell.role));
    return block;
}

// New tasks go behind those that are there. A finished run is found again; what had failed gets
// another chance.
void insert_tasks(const Database& database, const Plan& plan) {
    Statement insert = database.prepare(R"sql(
        INSERT INTO tasks (id, task, block, position, state)
        VALUES (?1, ?2, ?3, ?4, iif(EXISTS (SELECT 1 FROM runs WHERE id = ?1), 'done', 'pending'))
        ON CONFLICT (id) DO UPDATE SET
            task = excluded.task,
            losses = iif(state = 'failed', 0, losses),
            failures = iif(state = 'failed', 0, failures),
            error = iif(state = 'failed', '', error),
            state = iif(state = 'failed', 'pending', state))sql");
    std::int64_t position = database.integer("SELECT ifnull(max(position) + 1, 0) FROM tasks");
    for (const Cell& cell : plan.cells) {
        insert.bind(task_id(cell.task), task_to_json(cell.task).dump(), block_of(cell), position++)
            .run();
    }
}

void insert_cells(const Database& database, const Plan& plan) {
    Statement insert =
        database.prepare("INSERT INTO cells VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)");
    const auto references = references_of(plan);
    for (std::size_t i = 0; i < plan.cells.size(); ++i) {
        const Cell& cell = plan.cells[i];
        const auto bind = [&](const auto& a, const auto& b) {
            insert.bind(plan.experiment, i, cell.scene, cell.method, to_string(cell.budget),
                        cell.seed, to_string(cell.role), task_id(cell.task), a, b);
        };
        if (references[i]) {
            bind(references[i]->a, references[i]->b);
        } else {
            bind(nullptr, nullptr);
        }
        insert.run();
    }
}

std::string head_of(const Plan& plan) {
    Plan head = plan;
    head.cells.clear();
    return plan_to_json(head).dump();
}

// What no experiment asks for any more is not worked on, unless a worker is at it already.
void delete_unwanted_tasks(const Database& database) {
    database.execute(
        "DELETE FROM tasks WHERE state <> 'leased' AND id NOT IN (SELECT task FROM cells)");
}

constexpr std::string_view kSelectTasks =
    "SELECT id, task, block, position, state, epoch, worker, losses, failures, error FROM tasks ";

TaskRow task_row(const Statement& row) {
    return {.id = row.text(0),
            .task = task_from_json(nlohmann::json::parse(row.text(1))),
            .block = row.text(2),
            .position = row.integer(3),
            .state = task_state_from_string(row.text(4)),
            .epoch = row.integer(5),
            .worker = row.text(6),
            .losses = static_cast<int>(row.integer(7)),
            .failures = static_cast<int>(row.integer(8)),
            .error = row.text(9)};
}

}  // namespace

std::string to_string(TaskState state) {
    switch (state) {
        case TaskState::Pending:
            return "pending";
        case TaskState::Leased:
            return "leased";
        case TaskState::Done:
            return "done";
        case TaskState::Failed:
            break;
    }
    return "failed";
}

std::vector<std::optional<ReferenceIds>> references_of(const Plan& plan) {
    using Key = std::tuple<std::string, int, int>;
    const auto key = [](const Cell& cell) {
        return Key(cell.scene, cell.task.width, cell.task.height);
    };
    std::map<Key, ReferenceIds> halves;
    for (const Cell& cell : plan.cells) {
        if (cell.role == Role::ReferenceA) halves[key(cell)].a = task_id(cell.task);
        if (cell.role == Role::ReferenceB) halves[key(cell)].b = task_id(cell.task);
    }
    std::vector<std::optional<ReferenceIds>> references;
    for (const Cell& cell : plan.cells) {
        const auto found = halves.find(key(cell));
        const bool complete = cell.role == Role::Test && found != halves.end() &&
                              !found->second.a.empty() && !found->second.b.empty();
        references.push_back(complete ? std::optional(found->second) : std::nullopt);
    }
    return references;
}

void insert_experiment(const Database& database, const ExperimentFile& file) {
    const std::string& name = file.plan.experiment;
    Transaction transaction(database);
    database
        .prepare(
            "INSERT INTO experiments (name, submitted_at_ms, file_sha256, head) "
            "VALUES (?1, ?2, ?3, ?4) ON CONFLICT (name) DO UPDATE SET "
            "submitted_at_ms = excluded.submitted_at_ms, file_sha256 = excluded.file_sha256, "
            "head = excluded.head")
        .bind(name, file.submitted_at_ms, file.sha256, head_of(file.plan))
        .run();
    database.prepare("DELETE FROM cells WHERE experiment = ?1").bind(name).run();
    insert_tasks(database, file.plan);
    insert_cells(database, file.plan);
    delete_unwanted_tasks(database);
    transaction.commit();
}

void delete_experiment(const Database& database, const std::string& name) {
    Transaction transaction(database);
    database.prepare("DELETE FROM experiments WHERE name = ?1").bind(name).run();
    delete_unwanted_tasks(database);
    transaction.commit();
}

std::vector<TaskRow> select_tasks(const Database& database) {
    Statement select = database.prepare(std::string(kSelectTasks) + "ORDER BY position, id");
    std::vector<TaskRow> rows;
    while (select.step()) rows.push_back(task_row(select));
    return rows;
}

std::optional<TaskRow> select_task(const Database& database, const std::string& id) {
    Statement select = database.prepare(std::string(kSelectTasks) + "WHERE id = ?1");
    if (!select.bind(id).step()) return std::nullopt;
    return task_row(select);
}

void update_task_state(const Database& database, const TaskRow& row) {
    database
        .prepare(
            "UPDATE tasks SET state = ?2, epoch = ?3, worker = ?4, losses = ?5, "
            "failures = ?6, error = ?7 WHERE id = ?1")
        .bind(row.id, to_string(row.state), row.epoch, row.worker, row.losses, row.failures,
              row.error)
        .run();
}

std::int64_t take_epoch(const Database& database) {
    Statement update =
        database.prepare("UPDATE meta SET next_epoch = next_epoch + 1 RETURNING next_epoch - 1");
    MISBENCH_CHECK(update.step());
    const std::int64_t epoch = update.integer(0);
    update.run();
    return epoch;
}

Recorded insert_run(const Database& database, const Record& record) {
    const Task& task = record.task;
    const RenderStatistics& statistics = record.statistics;
    Transaction transaction(database);
    Statement insert = database.prepare(R"sql(
        INSERT INTO runs VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15,
                                 ?16, ?17, ?18, ?19, ?20, ?21, ?22, ?23, ?24, ?25, ?26, ?27, ?28,
                                 ?29)
        ON CONFLICT DO NOTHING RETURNING 1)sql");
    insert.bind(record.run, task.scene, task.scene_hash, task.width, task.height, task.method,
                task.method_version, parameters_to_json(task.parameters).dump(),
                to_string(task.budget), task.seed, record.valid, statistics.passes,
                statistics.threads, statistics.wall_seconds, statistics.cpu_seconds,
                statistics.rays, statistics.nonfinite_samples, statistics.negative_samples,
                statistics.involuntary_context_switches, statistics.steal_seconds, record.worker,
                record.epoch, record.finished_at, record.provenance.build_id,
                record.provenance.cpu_model, record.provenance.isa, record.provenance.compiler,
                record.provenance.flags, record.provenance.host);
    const bool is_new = insert.step();
    if (is_new) {
        insert.run();
        Statement snapshot =
            database.prepare("INSERT INTO snapshots VALUES (?1, ?2, ?3, ?4, ?5, ?6)");
        for (const auto& [at, sha256] : record.snapshots) {
            snapshot.bind(record.run, at.samples, at.passes, at.wall_seconds, at.cpu_seconds,
                          at.rays);
            snapshot.run();
        }
    }
    database.prepare("UPDATE tasks SET state = 'done', error = '' WHERE id = ?1")
        .bind(record.run)
        .run();
    // Where the clock was set back before the database was rebuilt.
    database.prepare("UPDATE meta SET next_epoch = max(next_epoch, ?1 + 1)")
        .bind(record.epoch)
        .run();
    transaction.commit();
    return is_new ? Recorded::New : Recorded::AlreadyThere;
}

}  // namespace misbench
