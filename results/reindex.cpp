#include "results/reindex.h"

#include <algorithm>
#include <set>

#include "renderer/base/error.h"
#include "renderer/base/files.h"
#include "renderer/base/log.h"
#include "results/job_table.h"
#include "results/measure.h"
#include "results/moments.h"
#include "results/rollup.h"
#include "results/run_directory.h"
#include "results/schema.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;

// What SQLite may leave beside a database.
constexpr std::array kCompanions = {"-wal", "-shm", "-journal"};

std::vector<fs::path> sorted_entries(const fs::path& folder) {
    std::vector<fs::path> entries;
    for (const auto& entry : fs::directory_iterator(folder)) entries.push_back(entry.path());
    std::ranges::sort(entries);
    return entries;
}

std::set<std::string> texts(const Database& database, std::string_view sql) {
    std::set<std::string> found;
    Statement select = database.prepare(sql);
    while (select.step()) found.insert(select.text(0));
    return found;
}

// Calls `read`; a damaged file is set aside and named, every other error is the caller's.
auto read_or_set_aside(const fs::path& store, const fs::path& path, Reindexed& result, auto&& read)
    -> std::optional<decltype(read(path))> {
    try {
        return read(path);
    } catch (const Error& e) {
        if (e.code() != Errc::DataLoss) throw;
        const fs::path kept = set_aside(store, path);
        result.damaged.push_back(path.lexically_relative(store).string());
        spdlog::warn("set aside as damaged path={} kept={} error={}", path.string(), kept.string(),
                     e.what());
        return std::nullopt;
    }
}

void index_runs(const Database& database, const fs::path& store, Reindexed& result) {
    const auto indexed = texts(database, "SELECT id FROM runs");
    for (const fs::path& path : sorted_entries(store / "runs")) {
        if (indexed.contains(path.filename())) continue;
        const auto record = read_or_set_aside(store, path, result, [](const fs::path& folder) {
            Record whole = read_whole_run(folder);
            if (whole.run != folder.filename()) {
                throw Error(Errc::DataLoss,
                            "read '" + folder.string() + "': it holds run " + whole.run);
            }
            return whole;
        });
        if (!record) continue;
        insert_run(database, *record);
        ++result.runs;
    }
}

void index_experiments(const Database& database, const fs::path& store, Reindexed& result) {
    const auto indexed = texts(database, "SELECT file_sha256 FROM experiments");
    for (const fs::path& path : sorted_entries(store / "experiments")) {
        // A crash while a file was written leaves its temporary name, the old file is whole.
        if (path.extension() != ".json") continue;
        const auto file = read_or_set_aside(store, path, result, read_experiment_file);
        if (!file || indexed.contains(file->sha256)) continue;
        insert_experiment(database, *file);
        ++result.experiments;
    }
}

// The old database goes first: beside a new one its log would be taken for the new one's. A crash
// in between leaves a store without database, which the next writer indexes again.
void replace_database(const fs::path& fresh, const fs::path& old) {
    fs::remove(old);
    for (const char* companion : kCompanions) fs::remove(old.string() + companion);
    sync_path(fresh);
    fs::rename(fresh, old);
    sync_path(old.parent_path());
}

}  // namespace

fs::path set_aside(const fs::path& store, const fs::path& damaged) {
    fs::create_directories(store / "damaged");
    fs::path to = store / "damaged" / damaged.filename();
    for (int n = 1; fs::exists(to); ++n) {
        to = store / "damaged" / (damaged.filename().string() + "." + std::to_string(n));
    }
    fs::rename(damaged, to);
    return to;
}

void make_folders(const fs::path& store) {
    std::error_code ignored;
    const bool is_store =
        fs::exists(store / "runs", ignored) || fs::exists(store / "results.sqlite", ignored);
    if (!is_store && fs::exists(store, ignored) && !fs::is_empty(store, ignored)) {
        throw Error(Errc::FailedPrecondition, "make store '" + store.string() +
                                                  "': the folder has other files and is no store");
    }
    try {
        for (const char* name : {"runs", "experiments", "incoming"}) {
            fs::create_directories(store / name);
        }
    } catch (const fs::filesystem_error& e) {
        const bool full = e.code() == std::errc::no_space_on_device;
        throw Error(full ? Errc::DataLoss : Errc::FailedPrecondition,
                    "make store '" + store.string() + "': " + e.code().message());
    }
}

Reindexed index_files(const Database& database, const fs::path& store) {
    Reindexed result;
    index_runs(database, store, result);
    index_experiments(database, store, result);
    return result;
}

Reindexed reindex(const fs::path& folder) {
    if (!fs::is_directory(folder / "runs")) {
        throw Error(Errc::NotFound,
                    "reindex '" + folder.string() + "': it has no runs/, so it is not a store");
    }
    const FileLock lock(folder / "lock");
    make_folders(folder);
    const fs::path fresh = folder / "results.sqlite.new";
    fs::remove(fresh);
    for (const char* companion : kCompanions) fs::remove(fresh.string() + companion);
    Reindexed result;
    {
        const auto database = open_database(fresh, Database::Access::ReadWrite);
        result = index_files(*database, folder);
        for (const fs::path& path : sorted_entries(folder / "experiments")) {
            if (path.extension() != ".json") continue;
            measure_plan(*database, folder, read_experiment_file(path).plan);
        }
        fs::remove_all(folder / kMomentsFolder);
        update_moments(*database, folder);
        roll_up(*database);
    }
    replace_database(fresh, folder / "results.sqlite");
    return result;
}

}  // namespace misbench
