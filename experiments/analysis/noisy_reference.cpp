#include "experiments/analysis/noisy_reference.h"

#include <optional>
#include <span>

#include "experiments/plan/imported.h"
#include "renderer/base/error.h"

namespace misbench {

std::vector<CellReferenceShare> cell_reference_shares(const Store& store, const Plan& plan) {
    std::vector<CellReferenceShare> cells;
    for (const CellSeeds& seeds : store.cell_seeds(plan.experiment, {})) {
        const std::optional<double> share = mean_reference_share(seeds);
        if (!share) continue;
        for (const Budget& budget : plan.budgets) {
            if (to_string(budget) != seeds.budget) continue;
            cells.push_back(
                {.scene = seeds.scene, .method = seeds.method, .budget = budget, .share = *share});
        }
    }
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
