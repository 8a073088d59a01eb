#include "results/measure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "renderer/base/error.h"
#include "results/job_table.h"
#include "results/metrics/metrics.h"
#include "results/reference_noise.h"
#include "results/run_directory.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;

// What one image of a tested run lacks. The reference's halves are read once for all of them.
struct Lack {
    std::string run;
    std::int64_t snapshot = 0;  // 0: the run's image
    std::vector<const Metric*> metrics;
    bool share = false;  // of the reference's noise
};

using PairIds = std::pair<std::string, std::string>;

// The plan's tested runs by the reference they are compared with, each once: two labels may share
// a run.
std::map<PairIds, std::set<std::string>> tested_runs(const Plan& plan) {
    std::map<PairIds, std::set<std::string>> tested;
    const auto references = references_of(plan);
    for (std::size_t i = 0; i < plan.cells.size(); ++i) {
        if (!references[i]) continue;
        tested[{references[i]->a, references[i]->b}].insert(task_id(plan.cells[i].task));
    }
    return tested;
}

bool is_valid_run(const Database& database, const std::string& id) {
    return database.prepare("SELECT 1 FROM runs WHERE id = ?1 AND valid = 1").bind(id).step();
}

// Of the snapshots of a run, and of its image as 0.
std::vector<std::int64_t> images_of(const Database& database, const std::string& run) {
    std::vector<std::int64_t> images{0};
    Statement select = database.prepare("SELECT samples FROM snapshots WHERE run = ?1 ORDER BY 1");
    select.bind(run);
    while (select.step()) images.push_back(select.integer(0));
    return images;
}

std::vector<Lack> lacks_of(const Database& database, const PairIds& pair,
                           const std::set<std::string>& runs,
                           const std::vector<const Metric*>& wanted) {
    std::vector<Lack> lacks;
    Statement there = database.prepare(
        "SELECT 1 FROM measurements WHERE run = ?1 AND snapshot = ?2 AND reference_a = ?3 "
        "AND reference_b = ?4 AND metric = ?5");
    Statement share_there = database.prepare(
        "SELECT 1 FROM reference_noise WHERE run = ?1 AND reference_a = ?2 AND reference_b = ?3");
    for (const std::string& run : runs) {
        if (!is_valid_run(database, run)) continue;
        for (const std::int64_t image : images_of(database, run)) {
            Lack lack{.run = run, .snapshot = image, .metrics = {}};
            for (const Metric* metric : wanted) {
                if (!there.bind(run, image, pair.first, pair.second, metric->id).step()) {
                    lack.metrics.push_back(metric);
                }
            }
            lack.share = image == 0 && !share_there.bind(run, pair.first, pair.second).step();
            if (lack.share || !lack.metrics.empty()) lacks.push_back(std::move(lack));
        }
    }
    return lacks;
}

// A run is invalid when it has non-finite samples, so its image or a reference's was damaged.
[[noreturn]] void throw_not_finite(const std::string& run, const Metric& metric) {
    throw Error(Errc::DataLoss, "measure run " + run + ": its " + std::string(metric.id) +
                                    " is not finite, although the run is valid");
}

int measure_against(const Database& database, const fs::path& store, const PairIds& pair,
                    const std::vector<Lack>& lacks) {
    const auto image_of = [&store](const std::string& run, std::int64_t snapshot = 0) {
        return read_exr(store / "runs" / run /
                        (snapshot == 0 ? kImageFile : snapshot_file(snapshot)));
    };
    const Image a = image_of(pair.first);
    const Image b = image_of(pair.second);
    struct Value {
        const Lack* of;
        const Metric* metric;  // null: the share of the reference's noise
        double value;
    };
    std::vector<Value> values;
    for (const Lack& lack : lacks) {
        const Image image = image_of(lack.run, lack.snapshot);
        for (const Metric* metric : lack.metrics) {
            values.push_back({&lack, metric, measure(*metric, image, {a, b})});
            if (!std::isfinite(values.back().value)) throw_not_finite(lack.run, *metric);
        }
        if (lack.share) values.push_back({&lack, nullptr, reference_share(image, {a, b})});
    }
    int n_added = 0;
    Transaction transaction(database);
    Statement insert = database.prepare("INSERT INTO measurements VALUES (?1, ?2, ?3, ?4, ?5, ?6)");
    Statement insert_share =
        database.prepare("INSERT INTO reference_noise VALUES (?1, ?2, ?3, ?4)");
    for (const auto& [of, metric, value] : values) {
        if (metric == nullptr) {
            insert_share.bind(of->run, pair.first, pair.second, value).run();
            continue;
        }
        insert.bind(of->run, of->snapshot, pair.first, pair.second, metric->id, value).run();
        ++n_added;
    }
    transaction.commit();
    return n_added;
}

// As in schema.cpp, of which the keys are what matters here.
constexpr const char* kTablesInMemory = R"sql(
PRAGMA temp_store = MEMORY;
CREATE TEMP TABLE measurements (
    run TEXT, snapshot INTEGER, reference_a TEXT, reference_b TEXT, metric TEXT, value REAL,
    PRIMARY KEY (run, snapshot, reference_a, reference_b, metric)) WITHOUT ROWID;
CREATE TEMP TABLE reference_noise (
    run TEXT, reference_a TEXT, reference_b TEXT, share REAL,
    PRIMARY KEY (run, reference_a, reference_b)) WITHOUT ROWID;
)sql";

void begin_in_memory(const Database& database, const std::string& experiment) {
    database.execute(kTablesInMemory);
    for (const std::string table : {"measurements", "reference_noise"}) {
        database
            .prepare("INSERT INTO temp." + table + " SELECT * FROM main." + table +
                     " WHERE run IN (SELECT task FROM cells WHERE experiment = ?1)")
            .bind(experiment)
            .run();
    }
}

}  // namespace

bool measures_in_memory(const Database& database) {
    return database.integer("SELECT count(*) FROM temp.sqlite_schema WHERE name = 'measurements'") >
           0;
}

int measure_plan(const Database& database, const fs::path& store, const Plan& plan,
                 MeasureInto into) {
    std::vector<const Metric*> wanted;
    for (const std::string& id : plan.metrics) wanted.push_back(&find_metric(id));
    int n_added = 0;
    for (const auto& [pair, runs] : tested_runs(plan)) {
        if (!is_valid_run(database, pair.first) || !is_valid_run(database, pair.second)) continue;
        const auto lacks = lacks_of(database, pair, runs, wanted);
        if (lacks.empty()) continue;
        if (into == MeasureInto::Memory && !measures_in_memory(database)) {
            begin_in_memory(database, plan.experiment);
        }
        n_added += measure_against(database, store, pair, lacks);
    }
    return n_added;
}

std::vector<Measurement> select_measurements(const Database& database, const Plan& plan) {
    std::vector<Measurement> measurements;
    Statement select = database.prepare(
        "SELECT metric, value FROM measurements WHERE run = ?1 AND snapshot = 0 "
        "AND reference_a = ?2 AND reference_b = ?3 ORDER BY metric");
    for (const auto& [pair, runs] : tested_runs(plan)) {
        for (const std::string& run : runs) {
            select.bind(run, pair.first, pair.second);
            while (select.step()) {
                const std::string metric = select.text(0);
                if (std::ranges::find(plan.metrics, metric) == plan.metrics.end()) continue;
                measurements.push_back({.run = run,
                                        .reference_a = pair.first,
                                        .reference_b = pair.second,
                                        .metric = metric,
                                        .value = select.real(1)});
            }
        }
    }
    return measurements;
}

std::vector<SnapshotMeasurement> select_snapshot_measurements(const Database& database,
                                                              const Plan& plan,
                                                              const std::string& metric) {
    std::vector<SnapshotMeasurement> measurements;
    Statement select = database.prepare(
        "SELECT s.samples, s.passes, s.wall_seconds, s.cpu_seconds, m.value "
        "FROM snapshots s JOIN measurements m ON m.run = s.run AND m.snapshot = s.samples "
        "WHERE s.run = ?1 AND m.reference_a = ?2 AND m.reference_b = ?3 AND m.metric = ?4 "
        "ORDER BY s.samples");
    for (const auto& [pair, runs] : tested_runs(plan)) {
        for (const std::string& run : runs) {
            select.bind(run, pair.first, pair.second, metric);
            while (select.step()) {
                measurements.push_back({.run = run,
                                        .samples = select.integer(0),
                                        .passes = select.integer(1),
                                        .wall_seconds = select.real(2),
                                        .cpu_seconds = select.real(3),
                                        .value = select.real(4)});
            }
        }
    }
    return measurements;
}

}  // namespace misbench
