#include "results/schema.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <utility>

#include "renderer/base/error.h"

namespace misbench {
namespace {

// Any change of a table or view counts it up; `misbench reindex` is the way from one to the next.
constexpr int kSchemaVersion = 3;
constexpr int kApplicationId = 0x6d697362;  // "misb"

// Comments inside a statement stay in the database, where `.schema` shows them.
constexpr const char* kTables = R"sql(
CREATE TABLE meta (
    id INTEGER PRIMARY KEY CHECK (id = 1),
    next_epoch INTEGER NOT NULL  -- of the next lease that is granted
) STRICT;

CREATE TABLE experiments (
    name TEXT PRIMARY KEY,
    submitted_at_ms INTEGER NOT NULL,  -- Unix time, different for each
    file_sha256 TEXT NOT NULL,         -- of experiments/NAME.json
    head TEXT NOT NULL CHECK (json_valid(head)),  -- of its plan: all but the cells
    rolled_up INTEGER NOT NULL DEFAULT 0 CHECK (rolled_up IN (0, 1))
) STRICT;

CREATE TABLE tasks (  -- the job table: its rows are the state of the queue
    id TEXT PRIMARY KEY,
    task TEXT NOT NULL CHECK (json_valid(task)),
    block TEXT NOT NULL,
    position INTEGER NOT NULL,
    state TEXT NOT NULL CHECK (state IN ('pending', 'leased', 'done', 'failed')),
    epoch INTEGER NOT NULL DEFAULT 0 CHECK (epoch >= 0),
    worker TEXT NOT NULL DEFAULT '',
    losses INTEGER NOT NULL DEFAULT 0 CHECK (losses >= 0),
    failures INTEGER NOT NULL DEFAULT 0 CHECK (failures >= 0),
    error TEXT NOT NULL DEFAULT ''
) STRICT;
CREATE INDEX tasks_by_position ON tasks (position);

CREATE TABLE cells (  -- of the experiments: scene × method × budget × seed
    experiment TEXT NOT NULL REFERENCES experiments (name) ON DELETE CASCADE,
    position INTEGER NOT NULL,
    scene TEXT NOT NULL,
    method TEXT NOT NULL,  -- the label in the experiment
    budget TEXT NOT NULL,
    seed INTEGER NOT NULL,
    role TEXT NOT NULL CHECK (role IN ('test', 'reference_a', 'reference_b')),
    task TEXT NOT NULL REFERENCES tasks (id),
    reference_a TEXT,  -- tasks of the reference's halves
    reference_b TEXT,
    PRIMARY KEY (experiment, position),
    CHECK ((reference_a IS NULL) = (reference_b IS NULL))
) STRICT, WITHOUT ROWID;
CREATE INDEX cells_by_task ON cells (task);
CREATE INDEX cells_of_references ON cells (experiment, scene)
    WHERE role IN ('reference_a', 'reference_b');

CREATE TABLE runs (  -- an index of runs/ID/record.json; a run has the id of its task
    id TEXT PRIMARY KEY,
    scene TEXT NOT NULL,
    scene_hash TEXT NOT NULL,
    width INTEGER NOT NULL CHECK (width > 0),
    height INTEGER NOT NULL CHECK (height > 0),
    method TEXT NOT NULL,  -- of the program, not the label
    method_version INTEGER NOT NULL,
    parameters TEXT NOT NULL CHECK (json_valid(parameters)),
    budget TEXT NOT NULL,
    seed INTEGER NOT NULL,
    valid INTEGER NOT NULL CHECK (valid IN (0, 1)),
    passes INTEGER NOT NULL CHECK (passes >= 0),
    threads INTEGER NOT NULL,
    wall_seconds REAL NOT NULL,
    cpu_seconds REAL NOT NULL,
    rays INTEGER NOT NULL,
    nonfinite_samples INTEGER NOT NULL,
    negative_samples INTEGER NOT NULL,
    involuntary_context_switches INTEGER NOT NULL,
    steal_seconds REAL NOT NULL,
    worker TEXT NOT NULL,
    epoch INTEGER NOT NULL,
    finished_at TEXT NOT NULL,
    build_id TEXT NOT NULL,
    cpu_model TEXT NOT NULL,
    isa TEXT NOT NULL,
    compiler TEXT NOT NULL,
    flags TEXT NOT NULL,
    host TEXT NOT NULL
) STRICT;
CREATE INDEX runs_by_cost ON runs (scene_hash, method, cpu_seconds, passes, width, height);

CREATE TABLE snapshots (  -- of runs, on their way to the image
    run TEXT NOT NULL REFERENCES runs (id),
    samples INTEGER NOT NULL CHECK (samples > 0),  -- passes rendered: names the file
    passes INTEGER NOT NULL CHECK (passes > 0),    -- those in the snapshot
    wall_seconds REAL NOT NULL,
    cpu_seconds REAL NOT NULL,
    rays INTEGER NOT NULL,
    PRIMARY KEY (run, samples)
) STRICT, WITHOUT ROWID;

CREATE TABLE measurements (
    run TEXT NOT NULL REFERENCES runs (id),
    snapshot INTEGER NOT NULL,  -- its samples; 0: the run's image itself
    reference_a TEXT NOT NULL REFERENCES runs (id),
    reference_b TEXT NOT NULL REFERENCES runs (id),
    metric TEXT NOT NULL,
    value REAL NOT NULL,
    PRIMARY KEY (run, snapshot, reference_a, reference_b, metric)
) STRICT, WITHOUT ROWID;

CREATE TABLE reference_noise (  -- how much of an image's naive relMSE is its reference's variance
    run TEXT NOT NULL REFERENCES runs (id),
    reference_a TEXT NOT NULL REFERENCES runs (id),
    reference_b TEXT NOT NULL REFERENCES runs (id),
    share REAL NOT NULL,  -- results/reference_noise.h
    PRIMARY KEY (run, reference_a, reference_b)
) STRICT, WITHOUT ROWID;

CREATE VIEW results AS
-- One row for each tested cell and metric; a cell without measurements has one row, whose metric
-- and value are NULL. state: pending, leased, failed, done, or invalid for a run that has
-- non-finite samples. method is the label in the experiment.
SELECT c.experiment, c.scene, c.method, c.budget, c.seed,
       CASE WHEN r.valid = 0 THEN 'invalid' ELSE t.state END AS state,
       m.metric, m.value,
       r.id AS run, r.valid, r.passes, r.threads, r.wall_seconds, r.cpu_seconds, r.rays,
       r.parameters, r.worker, r.finished_at, t.error
FROM cells c
JOIN tasks t ON t.id = c.task
LEFT JOIN runs r ON r.id = c.task
LEFT JOIN measurements m ON m.run = c.task AND m.snapshot = 0
                        AND m.reference_a = c.reference_a AND m.reference_b = c.reference_b
WHERE c.role = 'test';

CREATE VIEW curves AS
-- Error against effort: one row for each measured image of a tested cell, its snapshots and the
-- image itself, whose snapshot is 0.
SELECT c.experiment, c.scene, c.method, c.budget, c.seed, m.metric, m.snapshot,
       ifnull(s.passes, r.passes) AS passes, ifnull(s.wall_seconds, r.wall_seconds) AS wall_seconds,
       ifnull(s.cpu_seconds, r.cpu_seconds) AS cpu_seconds, ifnull(s.rays, r.rays) AS rays,
       m.value, c.task AS run
FROM cells c
JOIN runs r ON r.id = c.task
JOIN measurements m ON m.run = c.task AND m.reference_a = c.reference_a
                   AND m.reference_b = c.reference_b
LEFT JOIN snapshots s ON s.run = m.run AND s.samples = m.snapshot
WHERE c.role = 'test';
)sql";

// Copies of the tables above for fast reading (results/rollup.h), and what was computed from them.
// They are there exactly while experiments.rolled_up is 1: any change below them takes them away.
constexpr const char* kRollups = R"sql(
CREATE TABLE rollup_cells (  -- a row for each scene × method × budget
    experiment TEXT NOT NULL REFERENCES experiments (name) ON DELETE CASCADE,
    position INTEGER NOT NULL,
    scene TEXT NOT NULL,
    method TEXT NOT NULL,
    budget TEXT NOT NULL,
    parameters TEXT NOT NULL,
    states TEXT NOT NULL,  -- a letter for each seed: valid, invalid, failed, unfinished
    seeds BLOB NOT NULL,   -- int64, little endian; what follows is doubles
    passes BLOB NOT NULL,
    wall_seconds BLOB NOT NULL,
    cpu_seconds BLOB NOT NULL,
    rays BLOB NOT NULL,
    reference_shares BLOB NOT NULL,  -- of reference_noise; NaN where there is none
    PRIMARY KEY (experiment, position)
) STRICT;

CREATE TABLE rollup_values (
    experiment TEXT NOT NULL REFERENCES experiments (name) ON DELETE CASCADE,
    metric TEXT NOT NULL,
    position INTEGER NOT NULL,  -- of the row of rollup_cells
    numbers BLOB NOT NULL,      -- a double for each seed, NaN where there is none
    PRIMARY KEY (experiment, metric, position)
) STRICT;

CREATE TABLE rollup_origins (  -- of the tested runs: machines and builds
    experiment TEXT NOT NULL REFERENCES experiments (name) ON DELETE CASCADE,
    position INTEGER NOT NULL,
    build_id TEXT NOT NULL,
    compiler TEXT NOT NULL,
    flags TEXT NOT NULL,
    cpu_model TEXT NOT NULL,
    isa TEXT NOT NULL,
    host TEXT NOT NULL,
    threads INTEGER NOT NULL,
    n_runs INTEGER NOT NULL,
    PRIMARY KEY (experiment, position)
) STRICT;

CREATE TABLE comparisons (
-- One row for each ratio to a baseline that a table of one metric shows, with its 95 % interval.
-- p is of the test that the ratio is 1; adjusted_p that of Benjamini and Hochberg over all rows of
-- one experiment, metric and baseline. Rows are there from the end of `misbench run` until
-- anything that they were computed from changes.
    experiment TEXT NOT NULL REFERENCES experiments (name) ON DELETE CASCADE,
    metric TEXT NOT NULL,
    baseline TEXT NOT NULL,
    scene TEXT NOT NULL,
    method TEXT NOT NULL,
    budget TEXT NOT NULL,
    ratio REAL NOT NULL,
    low REAL,
    high REAL,
    p REAL,
    adjusted_p REAL,
    PRIMARY KEY (experiment, metric, baseline, scene, method, budget)
) STRICT;

CREATE TRIGGER rollup_ends AFTER UPDATE OF rolled_up ON experiments
WHEN OLD.rolled_up = 1 AND NEW.rolled_up = 0 BEGIN
    DELETE FROM rollup_cells WHERE experiment = NEW.name;
    DELETE FROM rollup_values WHERE experiment = NEW.name;
    DELETE FROM rollup_origins WHERE experiment = NEW.name;
    DELETE FROM comparisons WHERE experiment = NEW.name;
END;
)sql";

// A change of `table` ends the rollups of the experiments that have a cell of its `task`.
std::string ends_rollups(const std::string& table, const std::string& change,
                         const std::string& row, const std::string& task) {
    const std::string has_it = table == "cells"
                                   ? "name = " + row + ".experiment"
                                   : "EXISTS (SELECT 1 FROM cells WHERE task = " + row + "." +
                                         task + " AND experiment = name)";
    std::string name = table + "_" + change;
    std::ranges::replace(name, ' ', '_');
    return "CREATE TRIGGER " + name + "_ends_rollups_of_" + row + " AFTER " + change + " ON " +
           table + " BEGIN UPDATE experiments SET rolled_up = 0 WHERE rolled_up = 1 AND " + has_it +
           "; END;";
}

std::string all_that_ends_rollups() {
    std::string sql = ends_rollups("tasks", "UPDATE OF state", "NEW", "id");
    const std::array<std::pair<const char*, const char*>, 4> sources{
        {{"cells", "task"}, {"runs", "id"}, {"measurements", "run"}, {"reference_noise", "run"}}};
    for (const auto& [table, task] : sources) {
        sql += ends_rollups(table, "INSERT", "NEW", task);
        sql += ends_rollups(table, "UPDATE", "NEW", task);
        sql += ends_rollups(table, "UPDATE", "OLD", task);
        sql += ends_rollups(table, "DELETE", "OLD", task);
    }
    return sql;
}

void create_tables(const Database& database) {
    const auto now = std::chrono::duration_cast<std::chrono::milliseconds>(
        std::chrono::system_clock::now().time_since_epoch());
    Transaction transaction(database);
    database.execute(kTables);
    database.execute(kRollups);
    database.execute(all_that_ends_rollups());
    // Above all epochs of a database that was here before, as long as leases were granted at less
    // than one a millisecond over its life.
    database.prepare("INSERT INTO meta VALUES (1, ?1)").bind(now.count()).run();
    database.execute("PRAGMA application_id = " + std::to_string(kApplicationId));
    database.execute("PRAGMA user_version = " + std::to_string(kSchemaVersion));
    transaction.commit();
}

bool is_empty(const Database& database) {
    return database.integer("SELECT count(*) FROM sqlite_schema") == 0 &&
           database.integer("PRAGMA application_id") == 0;
}

}  // namespace

std::unique_ptr<Database> open_database(const std::filesystem::path& path,
                                        Database::Access access) {
    auto database = std::make_unique<Database>(path, access);
    const bool writable = access == Database::Access::ReadWrite;
    if (writable && is_empty(*database)) create_tables(*database);
    if (database->integer("PRAGMA application_id") != kApplicationId) {
        throw Error(Errc::FailedPrecondition,
                    "open '" + path.string() + "': it is not the database of a misbench store");
    }
    const auto version = database->integer("PRAGMA user_version");
    if (version != kSchemaVersion) {
        throw Error(Errc::FailedPrecondition,
                    "open '" + path.string() + "': its schema is version " +
                        std::to_string(version) + ", this program's is " +
                        std::to_string(kSchemaVersion) +
                        "; `misbench reindex` makes it anew from the runs");
    }
    if (writable) database->begin_writing();
    return database;
}

}  // namespace misbench
