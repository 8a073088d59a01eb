#include "experiments/analysis/cell_images.h"

#include <algorithm>

namespace misbench {
namespace {

bool is_valid(const Store& store, const std::string& id) {
    const std::optional<Record> record = store.run(id);
    return record && record->valid;
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
    Image mean = store.run_image(runs.front().run);
    std::vector<double> sums(mean.rgb.begin(), mean.rgb.end());
    for (std::size_t r = 1; r < runs.size(); ++r) {
        const Image image = store.run_image(runs[r].run);
        for (std::size_t i = 0; i < sums.size(); ++i) {
            sums[i] += static_cast<double>(image.rgb.at(i));
        }
    }
    const auto n = static_cast<double>(runs.size());
    std::ranges::transform(sums, mean.rgb.begin(),
                           [n](double sum) { return static_cast<float>(sum / n); });
    return mean;
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
