// The results store: a directory with results.sqlite, one directory per run and one JSON file per
// experiment. The files are the truth, the database is an index over them plus the job table.
//
//   STORE/results.sqlite         index, job table, measurements
//   STORE/experiments/NAME.json  the plan of each experiment
//   STORE/runs/ID/image.exr      float RGB, the mean over the passes
//   STORE/runs/ID/snapshot-N.exr the same after the first N passes, where the run keeps some
//   STORE/runs/ID/record.json    results/record.h
//   STORE/moments/ID.exr         mean and M2 of the images of a cell's seeds (moments.h); made from
//                                the runs, and again when they are gone
//   STORE/incoming/              uploads in progress; emptied when a writer opens the store
//   STORE/damaged/               what was found damaged is set aside here, nothing is deleted
//   STORE/lock                   held by the one process that writes
//
// One Store object and one SQLite connection per thread of use; not thread-safe.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiments/plan/experiment.h"
#include "renderer/base/files.h"
#include "renderer/image/image.h"
#include "results/cell_seeds.h"
#include "results/moments.h"
#include "results/record.h"

namespace misbench {

class Database;

enum class TaskState { Pending, Leased, Done, Failed };
std::string to_string(TaskState state);

// A row of the job table.
struct TaskRow {
    std::string id;
    Task task;
    std::string block;          // tasks of one block belong on one worker
    std::int64_t position = 0;  // order of work
    TaskState state = TaskState::Pending;
    std::int64_t epoch = 0;  // of the last grant, 0 before the first
    std::string worker;      // of the last grant
    int losses = 0;          // leases that expired
    int failures = 0;        // errors a worker reported
    std::string error;       // of the last failure
};

enum class Recorded { New, AlreadyThere };

// A number of one run. There is none for an invalid run or one whose reference is missing.
struct Measurement {
    std::string run;
    std::string reference_a;  // run ids of the reference's halves
    std::string reference_b;
    std::string metric;
    double value = 0;
};

// A number of an image on a run's way, and what it had cost.
struct SnapshotMeasurement {
    std::string run;
    std::int64_t samples = 0;  // of the snapshot
    std::int64_t passes = 0;
    double wall_seconds = 0;
    double cpu_seconds = 0;
    double value = 0;
};

// What tables need of a run, without opening its record.
struct RunSummary {
    bool valid = true;
    std::int64_t passes = 0;
    double wall_seconds = 0;
    double cpu_seconds = 0;
};

// A row of the table `comparisons`: the ratio of a method's mean to the baseline's.
struct StoredComparison {
    std::string experiment;
    std::string metric;
    std::string baseline;
    std::string scene;
    std::string method;
    std::string budget;
    double ratio = 1;
    std::optional<double> low;
    std::optional<double> high;
    std::optional<double> p;
    std::optional<double> adjusted_p;
};

// What was indexed from files: runs and experiments that had no row, and what was set aside in
// STORE/damaged/, by its path in the store.
struct Reindexed {
    int runs = 0;
    int experiments = 0;
    std::vector<std::string> damaged;
};

// Ends the name of an experiment of nothing but references, which is there while they are rendered.
inline constexpr const char* kReferencesAlone = ".references";

class Store {
 public:
    enum class Access { ReadOnly, ReadWrite };

    // ReadWrite creates the store if needed, takes its lock, empties incoming/ and adds to the
    // index what a crash left out of it, also when results.sqlite is gone. ReadOnly never changes
    // a byte and needs no lock. Throws NotFound (ReadOnly, no store), FailedPrecondition (in use,
    // read-only, other schema version, not a store), DataLoss (damaged, disk full).
    Store(const std::filesystem::path& folder, Access access);
    ~Store();
    Store(Store&&) noexcept;
    Store& operator=(Store&&) noexcept;

    const std::filesystem::path& folder() const { return folder_; }
    // Another database is in the place of this one: reindex() made it.
    bool is_outdated() const;

    // --- experiments ---------------------------------------------------------------------------
    // Writes the plan's file, then its rows: cells, and tasks that are new. Replaces an experiment
    // of the same name; its runs stay, and so do its imported images (experiments/plan/imported.h).
    // A Failed task that is planned again becomes Pending, with its losses and failures forgotten.
    // A task that no experiment asks for any more leaves the job table, unless it is Leased. Throws
    // InvalidArgument for a name that cannot be a file's, and like keep_imported().
    enum class ImportedImages { Stay, AsPlanned };
    void put_experiment(const Plan& plan, ImportedImages imported = ImportedImages::Stay);
    // Its runs stay; its tasks leave the job table like above. Nothing happens where there is none.
    void drop_experiment(const std::string& name);
    // Names, the latest put first, those of references alone last.
    std::vector<std::string> experiments() const;
    // "" means the latest. Throws NotFound with the names that are known.
    Plan experiment(const std::string& name) const;
    // The same without its cells, which are most of a large plan: all that a table needs.
    Plan experiment_head(const std::string& name) const;

    // --- job table -----------------------------------------------------------------------------
    std::vector<TaskRow> tasks() const;  // by position
    std::optional<TaskRow> task(const std::string& id) const;
    // Epochs grow over the whole life of a store; a rebuilt database starts above all before it.
    // Durable when it returns.
    std::int64_t next_epoch();
    // State, epoch, worker, losses, failures, error. Nothing happens for a task that has left.
    void save_task_state(const TaskRow& row);

    // --- runs ----------------------------------------------------------------------------------
    // A fresh folder in incoming/ to put record.json and its images into.
    std::filesystem::path stage(const std::string& task, std::int64_t epoch) const;
    // Publishes a staged folder as the run's directory, then the run's row and its task's Done.
    // The folder is removed when the run is already there. Throws DataLoss, with the folder left
    // as it is, when the record is damaged or an image is not the one that it names.
    Recorded commit_run(const std::filesystem::path& staged);
    bool has_run(const std::string& id) const;
    std::optional<Record> run(const std::string& id) const;
    Image run_image(const std::string& id) const;
    Image snapshot_image(const std::string& id, std::int64_t samples) const;
    std::filesystem::path run_folder(const std::string& id) const;
    std::map<std::string, RunSummary> run_summaries() const;  // by id
    // CPU seconds (of all threads) per pixel and pass, over all runs seen so far of this scene
    // content and method, if any.
    std::optional<double> seconds_per_sample(const std::string& scene_hash,
                                             const std::string& method) const;

    // --- measurements --------------------------------------------------------------------------
    // Computes and stores what the plan's metrics still lack, wherever the run and both halves of
    // its reference are there and valid, of images and of snapshots; then makes the moments of all
    // cells and the rollups anew. Returns how many measurements were added.
    int measure(const Plan& plan);
    // The same measurements in memory, for this object alone, which may be ReadOnly: of an
    // experiment that another process is running. May be called again as runs come in.
    int measure_in_memory(const Plan& plan);
    std::vector<Measurement> measurements(const Plan& plan) const;  // of images
    // By run, then samples.
    std::vector<SnapshotMeasurement> snapshot_measurements(const Plan& plan,
                                                           const std::string& metric) const;
    // Mean and M2 of the images of these runs, by pixel: from STORE/moments/ where they are there.
    // REQUIRES: at least one run; all of one image size.
    PixelMoments moments(const std::vector<std::string>& runs) const;

    // --- what tables ask -----------------------------------------------------------------------
    // The tested cells of an experiment with the values of these metrics, by the plan's order.
    std::vector<CellSeeds> cell_seeds(const std::string& experiment,
                                      std::span<const std::string> metrics) const;
    // Machines and builds of the tested runs; references do not decide times.
    std::vector<Origin> origins(const std::string& experiment) const;
    // Scenes whose halves of the reference are one image: its noise does not cancel.
    std::vector<std::string> single_references(const std::string& experiment) const;
    // Replaces those of the experiment, metric and baseline. They go with the next change of what
    // they were computed from.
    void put_comparisons(const std::vector<StoredComparison>& comparisons);

 private:
    std::string known_experiment(const std::string& name) const;

    std::filesystem::path folder_;
    std::unique_ptr<FileLock> lock_;
    std::unique_ptr<Database> database_;
};

// Rebuilds the database of a store from its run directories and experiment files, measures anew,
// and only then puts it in the place of the old one. What only the old database knew is lost: how
// often tasks failed. Throws like opening for ReadWrite, and NotFound when the folder is no store.
Reindexed reindex(const std::filesystem::path& folder);

}  // namespace misbench
