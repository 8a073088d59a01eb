#include "results/measure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "renderer/base/error.h"
#include "results/job_table.h"
#include "results/metrics/metrics.h"
#include "results/run_directory.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;

// What one tested run lacks. The reference's halves are read once for all of their runs.
struct Lack {
    std::string run;
    std::vector<const Metric*> metrics;
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

std::vector<Lack> lacks_of(const Database& database, const PairIds& pair,
                           const std::set<std::string>& runs,
                           const std::vector<const Metric*>& wanted) {
    std::vector<Lack> lacks;
    Statement there = database.prepare(
        "SELECT 1 FROM measurements "
        "WHERE run = ?1 AND reference_a = ?2 AND reference_b = ?3 AND metric = ?4");
    for (const std::string& run : runs) {
        if (!is_valid_run(database, run)) continue;
        Lack lack{.run = run, .metrics = {}};
        for (const Metric* metric : wanted) {
            if (!there.bind(run, pair.first, pair.second, metric->id).step()) {
                lack.metrics.push_back(metric);
            }
        }
        if (!lack.metrics.empty()) lacks.push_back(std::move(lack));
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
    const auto image_of = [&store](const std::string& run) {
        return read_exr(store / "runs" / run / kImageFile);
    };
    const Image a = image_of(pair.first);
    const Image b = image_of(pair.second);
    std::vector<Measurement> added;
    for (const Lack& lack : lacks) {
        const Image image = image_of(lack.run);
        for (const Metric* metric : lack.metrics) {
            const double value = measure(*metric, image, {a, b});
            if (!std::isfinite(value)) throw_not_finite(lack.run, *metric);
            added.push_back({.run = lack.run,
                             .reference_a = pair.first,
                             .reference_b = pair.second,
                             .metric = std::string(metric->id),
                             .value = value});
        }
    }
    Transaction transaction(database);
    Statement insert = database.prepare("INSERT INTO measurements VALUES (?1, ?2, ?3, ?4, ?5)");
    for (const Measurement& m : added) {
        insert.bind(m.run, m.reference_a, m.reference_b, m.metric, m.value).run();
    }
    transaction.commit();
    return static_cast<int>(added.size());
}

}  // namespace

int measure_plan(const Database& database, const fs::path& store, const Plan& plan) {
    std::vector<const Metric*> wanted;
    for (const std::string& id : plan.metrics) wanted.push_back(&find_metric(id));
    int n_added = 0;
    for (const auto& [pair, runs] : tested_runs(plan)) {
        if (!is_valid_run(database, pair.first) || !is_valid_run(database, pair.second)) continue;
        const auto lacks = lacks_of(database, pair, runs, wanted);
        if (!lacks.empty()) n_added += measure_against(database, store, pair, lacks);
    }
    return n_added;
}

std::vector<Measurement> select_measurements(const Database& database, const Plan& plan) {
    std::vector<Measurement> measurements;
    Statement select = database.prepare(
        "SELECT metric, value FROM measurements "
        "WHERE run = ?1 AND reference_a = ?2 AND reference_b = ?3 ORDER BY metric");
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

}  // namespace misbench
