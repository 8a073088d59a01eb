#include "experiments/analysis/convergence.h"

#include <algorithm>
#include <map>

namespace misbench {
namespace {

using ByRun = std::map<std::string, std::vector<SnapshotMeasurement>>;

ByRun snapshots_by_run(const Store& store, const Plan& plan, const std::string& metric) {
    ByRun by_run;
    for (const SnapshotMeasurement& m : store.snapshot_measurements(plan, metric)) {
        by_run[m.run].push_back(m);
    }
    return by_run;
}

CurvePoint point_of(const ComparedCell& cell) {
    return {.passes = cell.mean_passes,
            .cpu_seconds = cell.mean_cpu_seconds,
            .wall_seconds = cell.mean_wall_seconds,
            .values = cell.values,
            .seeds = cell.seeds,
            .mean = cell.mean};
}

// In the order of the cell's seeds.
std::vector<std::string> runs_of(const Plan& plan, const ComparedCell& cell) {
    std::vector<std::string> runs;
    for (const Cell& planned : plan.cells) {
        const bool is_here = planned.role == Role::Test && planned.scene == cell.scene &&
                             planned.method == cell.method && planned.budget == cell.budget;
        if (is_here && std::ranges::find(cell.seeds, planned.seed) != cell.seeds.end()) {
            runs.push_back(task_id(planned.task));
        }
    }
    return runs;
}

// Points that all seeds of the cell have.
std::vector<std::pair<std::int64_t, CurvePoint>> snapshot_points(
    const ComparedCell& cell, const std::vector<std::string>& runs, const ByRun& by_run) {
    std::map<std::int64_t, CurvePoint> points;
    for (const std::string& run : runs) {
        const auto found = by_run.find(run);
        if (found == by_run.end()) return {};
        for (const SnapshotMeasurement& m : found->second) {
            CurvePoint& point = points[m.samples];
            const auto n = static_cast<double>(runs.size());
            point.passes += static_cast<double>(m.passes) / n;
            point.cpu_seconds += m.cpu_seconds / n;
            point.wall_seconds += m.wall_seconds / n;
            point.values.push_back(m.value);
        }
    }
    std::vector<std::pair<std::int64_t, CurvePoint>> complete;
    for (auto& [samples, point] : points) {
        if (point.values.size() != runs.size()) continue;
        point.seeds = cell.seeds;
        point.mean = estimate_mean(point.values);
        point.is_snapshot = true;
        complete.emplace_back(samples, std::move(point));
    }
    return complete;
}

}  // namespace

std::vector<Curve> convergence(const Store& store, const Plan& plan, const std::string& metric) {
    const Comparison comparison = compare(store, plan, metric);
    const ByRun by_run = snapshots_by_run(store, plan, comparison.metric);
    std::vector<Curve> curves;
    for (const std::string& scene : comparison.scenes) {
        for (const std::string& method : comparison.methods) {
            Curve curve{.scene = scene, .method = method, .points = {}};
            std::vector<const ComparedCell*> cells;
            for (const Budget& budget : comparison.budgets) {
                const ComparedCell* cell = comparison.find(scene, method, budget);
                if (cell == nullptr || cell->values.empty()) continue;
                curve.points.push_back(point_of(*cell));
                cells.push_back(cell);
            }
            std::ranges::stable_sort(cells, std::greater{}, &ComparedCell::mean_passes);
            for (const ComparedCell* cell : cells) {
                auto snapshots = snapshot_points(*cell, runs_of(plan, *cell), by_run);
                for (auto& [samples, point] : snapshots) {
                    const Budget same = SampleBudget{samples};
                    if (std::ranges::find(cells, same, &ComparedCell::budget) != cells.end()) {
                        continue;
                    }
                    curve.points.push_back(std::move(point));
                }
                if (!snapshots.empty()) break;
            }
            std::ranges::sort(curve.points, {}, &CurvePoint::passes);
            if (!curve.points.empty()) curves.push_back(std::move(curve));
        }
    }
    return curves;
}

}  // namespace misbench
