// misbench reference: how much of each error is the reference's noise, and a better reference.
#include <fmt/format.h>

#include <algorithm>

#include "experiments/analysis/noisy_reference.h"
#include "experiments/cli/output.h"
#include "experiments/cli/verbs.h"
#include "renderer/base/error.h"
#include "renderer/base/log.h"

namespace misbench {
namespace {

std::set<std::string> noisy_scenes(const std::vector<CellReferenceShare>& cells) {
    std::set<std::string> scenes;
    for (const CellReferenceShare& cell : cells) {
        if (cell.is_noisy()) scenes.insert(cell.scene);
    }
    return scenes;
}

// The largest share of each scene, and in which cell it is.
std::string to_text(const Plan& plan, const std::vector<CellReferenceShare>& cells) {
    std::vector<std::vector<std::string>> rows{
        {"scene", "samples", "share", "method", "budget", ""}};
    for (const PlannedScene& scene : plan.scenes) {
        const CellReferenceShare* worst = nullptr;
        for (const CellReferenceShare& cell : cells) {
            if (cell.scene != scene.name) continue;
            if (worst == nullptr || cell.share > worst->share) worst = &cell;
        }
        const auto half = std::ranges::find_if(plan.cells, [&scene](const Cell& cell) {
            return cell.scene == scene.name && cell.role == Role::ReferenceA;
        });
        if (worst == nullptr || half == plan.cells.end()) continue;
        rows.push_back({scene.name, "2 × " + to_string(half->budget),
                        fmt::format("{:.2g} %", 100 * worst->share), worst->method,
                        to_string(worst->budget), worst->is_noisy() ? "too noisy" : ""});
    }
    return align(rows) +
           fmt::format(
               "\nshare: of the reference's variance in a cell's naive relMSE, the largest "
               "of the scene; too noisy above {:g} %\n",
               100 * kNoisyReference);
}

}  // namespace

int reference_verb(const ReferenceOptions& options) {
    Plan plan;
    std::vector<CellReferenceShare> cells;
    {
        const Store store(options.run.store, Store::Access::ReadOnly);
        plan = store.experiment(options.experiment);
        cells = cell_reference_shares(store, plan);
    }
    if (!options.improve) {
        print_result(to_text(plan, cells));
        return 0;
    }
    std::set<std::string> scenes = noisy_scenes(cells);
    if (options.all) {
        for (const PlannedScene& scene : plan.scenes) scenes.insert(scene.name);
    }
    if (scenes.empty() && *options.improve > 1) {
        print_note("no reference is too noisy; --all improves those of all scenes");
        return 0;
    }
    init_log("misbench", "info");
    RunOptions run = options.run;
    run.command_line =
        "misbench reference " + run.store + " --experiment " + plan.experiment + " --improve 1";
    return run_plan(run, with_better_references(plan, scenes, *options.improve));
}

}  // namespace misbench
