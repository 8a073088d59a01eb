#include "experiments/analysis/cell_images.h"

#include <algorithm>
#include <cmath>

namespace misbench {
namespace {

bool is_valid(const Store& store, const std::string& id) {
    const std::optional<Record> record = store.run(id);
    return record && record->valid;
}

std::vector<std::string> ids_of(const std::vector<CellRun>& runs) {
    std::vector<std::string> ids;
    for (const CellRun& run : runs) ids.push_back(run.run);
    return ids;
}

}  // namespace

std::vector<CellRun> finished_runs(const Store& store, const Plan& plan, const std::string& scene,
                                   const std::string& method, const Budget& budget) {
    std::vector<CellRun> runs;
    for (const Cell& cell : plan.cells) {
        const bool is_here = cell.role == Role::Test && cell.scene == scene &&
                             cell.method == method && cell.budget == budget;
        if (!is_here) continue;
        const std::string id = task_id(cell.task);
        if (is_valid(store, id)) runs.push_back({.seed = cell.seed, .run = id});
    }
    return runs;
}

std::optional<Image> mean_image(const Store& store, const std::vector<CellRun>& runs) {
    if (runs.empty()) return std::nullopt;
    return store.moments(ids_of(runs)).mean;
}

std::optional<Image> standard_error_image(const Store& store, const std::vector<CellRun>& runs) {
    if (runs.size() < 2) return std::nullopt;
    PixelMoments moments = store.moments(ids_of(runs));
    const double n = moments.n;
    std::ranges::transform(moments.m2.rgb, moments.m2.rgb.begin(), [n](float m2) {
        return static_cast<float>(std::sqrt(static_cast<double>(m2) / (n - 1) / n));
    });
    return std::move(moments.m2);
}

std::optional<ReferenceImages> reference_images(const Store& store, const Plan& plan,
                                                const std::string& scene) {
    std::vector<CellRun> halves;
    for (const Role role : {Role::ReferenceA, Role::ReferenceB}) {
        const auto cell = std::ranges::find_if(
            plan.cells, [&](const Cell& c) { return c.scene == scene && c.role == role; });
        if (cell == plan.cells.end()) return std::nullopt;
        const std::string id = task_id(cell->task);
        if (!is_valid(store, id)) return std::nullopt;
        halves.push_back({.seed = cell->seed, .run = id});
    }
    return ReferenceImages{.a = store.run_image(halves[0].run),
                           .b = store.run_image(halves[1].run),
                           .mean = *mean_image(store, halves)};
}

}  // namespace misbench
