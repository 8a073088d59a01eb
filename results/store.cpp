#include "results/store.h"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "experiments/plan/imported.h"
#include "renderer/base/error.h"
#include "renderer/base/log.h"
#include "results/job_table.h"
#include "results/measure.h"
#include "results/reindex.h"
#include "results/rollup.h"
#include "results/run_directory.h"
#include "results/schema.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;

void empty_folder(const fs::path& folder) {
    for (const auto& entry : fs::directory_iterator(folder)) fs::remove_all(entry.path());
}

}  // namespace

Store::Store(const fs::path& folder, Access access) : folder_(folder) {
    const fs::path path = folder / "results.sqlite";
    if (access == Access::ReadOnly) {
        std::error_code ignored;
        if (!fs::exists(path, ignored)) {
            throw Error(Errc::NotFound, "open store '" + folder.string() +
                                            "': it has no results.sqlite" +
                                            (fs::is_directory(folder / "runs", ignored)
                                                 ? "; `misbench reindex` makes one from the runs"
                                                 : ""));
        }
        database_ = open_database(path, Database::Access::ReadOnly);
        return;
    }
    make_folders(folder);
    lock_ = std::make_unique<FileLock>(folder / "lock");
    database_ = open_database(path, Database::Access::ReadWrite);
    sync_path(folder);
    empty_folder(folder / "incoming");
    const Reindexed found = index_files(*database_, folder);
    if (found.runs + found.experiments > 0) {
        spdlog::info("index completed runs={} experiments={}", found.runs, found.experiments);
    }
}

Store::~Store() = default;
Store::Store(Store&&) noexcept = default;
Store& Store::operator=(Store&&) noexcept = default;

void Store::put_experiment(const Plan& plan, ImportedImages imported) {
    const auto now = std::chrono::duration_cast<std::chrono::milliseconds>(
                         std::chrono::system_clock::now().time_since_epoch())
                         .count();
    // Always the latest, whatever the clock says.
    const auto after =
        database_->integer("SELECT ifnull(max(submitted_at_ms), 0) + 1 FROM experiments");
    Plan kept = plan;
    const fs::path path = experiment_path(folder_, plan.experiment);
    if (imported == ImportedImages::Stay && fs::exists(path)) {
        for (const std::string& what : keep_imported(kept, read_experiment_file(path).plan)) {
            spdlog::warn("imported image left out experiment={} image={}", plan.experiment, what);
        }
    }
    insert_experiment(*database_, write_experiment_file(folder_, kept, std::max(now, after)));
}

void Store::drop_experiment(const std::string& name) {
    delete_experiment(*database_, name);
    fs::remove(experiment_path(folder_, name));
}

bool Store::is_outdated() const { return database_->has_moved(); }

std::vector<std::string> Store::experiments() const {
    Statement select =
        database_->prepare("SELECT name FROM experiments ORDER BY submitted_at_ms DESC, name");
    std::vector<std::string> names;
    while (select.step()) names.push_back(select.text(0));
    std::ranges::stable_partition(
        names, [](const std::string& name) { return !name.ends_with(kReferencesAlone); });
    return names;
}

std::string Store::known_experiment(const std::string& name) const {
    const auto names = experiments();
    if (names.empty()) {
        throw Error(Errc::NotFound, "store '" + folder_.string() + "' has no experiments");
    }
    const std::string& wanted = name.empty() ? names.front() : name;
    if (std::ranges::find(names, wanted) == names.end()) {
        std::string known;
        for (const std::string& n : names) known += " " + n;
        throw Error(Errc::NotFound, "unknown experiment '" + wanted + "'; known:" + known);
    }
    return wanted;
}

Plan Store::experiment(const std::string& name) const {
    return read_experiment_file(experiment_path(folder_, known_experiment(name))).plan;
}

Plan Store::experiment_head(const std::string& name) const {
    Statement select = database_->prepare("SELECT head FROM experiments WHERE name = ?1");
    select.bind(known_experiment(name)).step();
    return plan_from_json(nlohmann::json::parse(select.text(0)));
}

std::vector<TaskRow> Store::tasks() const { return select_tasks(*database_); }

std::optional<TaskRow> Store::task(const std::string& id) const {
    return select_task(*database_, id);
}

std::int64_t Store::next_epoch() { return take_epoch(*database_); }

void Store::save_task_state(const TaskRow& row) { update_task_state(*database_, row); }

fs::path Store::stage(const std::string& task, std::int64_t epoch) const {
    const fs::path staged = folder_ / "incoming" / (task + "." + std::to_string(epoch));
    fs::remove_all(staged);
    std::error_code error;
    fs::create_directories(staged, error);
    if (error) {
        throw Error(Errc::DataLoss, "make '" + staged.string() + "': " + error.message());
    }
    return staged;
}

Recorded Store::commit_run(const fs::path& staged) {
    const Record record = read_whole_run(staged);
    const fs::path folder = run_folder(record.run);
    if (has_run(record.run)) {
        fs::remove_all(staged);
        return Recorded::AlreadyThere;
    }
    // A folder without a row: an earlier commit got so far and failed at the database.
    if (fs::exists(folder)) {
        index_files(*database_, folder_);
        return commit_run(staged);
    }
    publish_folder(staged, folder);
    return insert_run(*database_, record);
}

bool Store::has_run(const std::string& id) const {
    return database_->prepare("SELECT 1 FROM runs WHERE id = ?1").bind(id).step();
}

std::optional<Record> Store::run(const std::string& id) const {
    if (!has_run(id)) return std::nullopt;
    return read_record(run_folder(id));
}

Image Store::run_image(const std::string& id) const {
    return read_exr(run_folder(id) / kImageFile);
}

Image Store::snapshot_image(const std::string& id, std::int64_t samples) const {
    return read_exr(run_folder(id) / snapshot_file(samples));
}

fs::path Store::run_folder(const std::string& id) const { return folder_ / "runs" / id; }

std::map<std::string, RunSummary> Store::run_summaries() const {
    Statement select =
        database_->prepare("SELECT id, valid, passes, wall_seconds, cpu_seconds FROM runs");
    std::map<std::string, RunSummary> summaries;
    while (select.step()) {
        summaries[select.text(0)] = {.valid = select.integer(1) == 1,
                                     .passes = select.integer(2),
                                     .wall_seconds = select.real(3),
                                     .cpu_seconds = select.real(4)};
    }
    return summaries;
}

std::optional<double> Store::seconds_per_sample(const std::string& scene_hash,
                                                const std::string& method) const {
    Statement select = database_->prepare(
        "SELECT total(cpu_seconds), total(passes * width * height) FROM runs "
        "WHERE scene_hash = ?1 AND method = ?2");
    select.bind(scene_hash, method).step();
    const double samples = select.real(1);
    if (samples <= 0) return std::nullopt;
    return select.real(0) / samples;
}

int Store::measure(const Plan& plan) {
    const int n_added = measure_plan(*database_, folder_, plan);
    update_moments(*database_, folder_);
    roll_up(*database_);
    return n_added;
}

int Store::measure_in_memory(const Plan& plan) {
    return measure_plan(*database_, folder_, plan, MeasureInto::Memory);
}

std::vector<CellSeeds> Store::cell_seeds(const std::string& experiment,
                                         std::span<const std::string> metrics) const {
    return select_cells(*database_, experiment, metrics);
}

std::vector<Origin> Store::origins(const std::string& experiment) const {
    return select_origins(*database_, experiment);
}

std::vector<std::string> Store::single_references(const std::string& experiment) const {
    Statement select = database_->prepare(R"sql(
        SELECT DISTINCT a.scene FROM cells a JOIN cells b
          ON b.experiment = a.experiment AND b.scene = a.scene AND b.task = a.task
        WHERE a.experiment = ?1 AND a.role = 'reference_a' AND b.role = 'reference_b'
          AND a.role IN ('reference_a', 'reference_b') AND b.role IN ('reference_a', 'reference_b')
        ORDER BY a.scene)sql");
    std::vector<std::string> scenes;
    select.bind(experiment);
    while (select.step()) scenes.push_back(select.text(0));
    return scenes;
}

void Store::put_comparisons(const std::vector<StoredComparison>& comparisons) {
    insert_comparisons(*database_, comparisons);
}

std::vector<Measurement> Store::measurements(const Plan& plan) const {
    return select_measurements(*database_, plan);
}

std::vector<SnapshotMeasurement> Store::snapshot_measurements(const Plan& plan,
                                                              const std::string& metric) const {
    return select_snapshot_measurements(*database_, plan, metric);
}

PixelMoments Store::moments(const std::vector<std::string>& runs) const {
    return read_or_compute_moments(folder_, runs);
}

}  // namespace misbench
