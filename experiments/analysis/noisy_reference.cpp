#include "experiments/analysis/noisy_reference.h"

#include <algorithm>
#include <map>

#include "experiments/plan/imported.h"
#include "renderer/base/error.h"

namespace misbench {

std::vector<CellReferenceShare> cell_reference_shares(const Store& store, const Plan& plan) {
    const std::map<std::string, double> by_run = store.reference_shares(plan);
    std::vector<CellReferenceShare> cells;
    std::vector<int> n_seeds;
    for (const Cell& cell : plan.cells) {
        if (cell.role != Role::Test) continue;
        const auto share = by_run.find(task_id(cell.task));
        if (share == by_run.end()) continue;
        const auto found = std::ranges::find_if(cells, [&cell](const CellReferenceShare& other) {
            return other.scene == cell.scene && other.method == cell.method &&
                   other.budget == cell.budget;
        });
        const auto i = static_cast<std::size_t>(found - cells.begin());
        if (found == cells.end()) {
            cells.push_back(
                {.scene = cell.scene, .method = cell.method, .budget = cell.budget, .share = 0});
            n_seeds.push_back(0);
        }
        cells[i].share += share->second;
        ++n_seeds[i];
    }
    for (std::size_t i = 0; i < cells.size(); ++i) cells[i].share /= n_seeds[i];
    return cells;
}

Plan with_better_references(Plan plan, const std::set<std::string>& scenes, std::int64_t factor) {
    for (Cell& cell : plan.cells) {
        if (cell.role == Role::Test || !scenes.contains(cell.scene)) continue;
        if (is_imported(cell.task)) {
            throw Error(Errc::InvalidArgument, "improve the reference of '" + cell.scene +
                                                   "': it was imported; import a better one");
        }
        auto* samples = std::get_if<SampleBudget>(&cell.budget);
        std::int64_t product = 0;
        if (samples == nullptr || __builtin_mul_overflow(samples->samples, factor, &product)) {
            throw Error(Errc::InvalidArgument,
                        "improve the reference of '" + cell.scene + "' " + std::to_string(factor) +
                            " times: its budget is " + to_string(cell.budget));
        }
        samples->samples = product;
        cell.task.budget = cell.budget;
    }
    return plan;
}

Plan references_alone(const Plan& plan, const std::set<std::string>& scenes) {
    Plan halves{.experiment = plan.experiment + kReferencesAlone,
                .description = "",
                .scenes = {},
                .methods = {},
                .budgets = {},
                .baseline = "",
                .metrics = plan.metrics,
                .cells = {},
                .configuration = "{}"};
    for (const PlannedScene& scene : plan.scenes) {
        if (scenes.contains(scene.name)) halves.scenes.push_back(scene);
    }
    for (const Cell& cell : plan.cells) {
        if (cell.role != Role::Test && scenes.contains(cell.scene)) halves.cells.push_back(cell);
    }
    return halves;
}

}  // namespace misbench
