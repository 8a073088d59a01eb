// misbench reference: how much of each error is the reference's noise, and a better reference.
#include <fmt/format.h>

#include <algorithm>

#include "experiments/analysis/comparison.h"
#include "experiments/analysis/noisy_reference.h"
#include "experiments/cli/local_run.h"
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

bool are_valid(const Store& store, const Plan& halves) {
    const auto runs = store.run_summaries();
    return std::ranges::all_of(halves.cells, [&runs](const Cell& half) {
        const auto run = runs.find(task_id(half.task));
        return run != runs.end() && run->second.valid;
    });
}

// The experiment keeps the reference that it has until all of the better one is there.
int improve(const RunOptions& options, const Plan& improved, const std::set<std::string>& scenes) {
    const Plan halves = references_alone(improved, scenes);
    const bool is_complete = do_tasks(options, halves, "references: ");
    Store store(options.store, Store::Access::ReadWrite);
    const bool has_failures = is_complete && report_failures(store, halves);
    store.drop_experiment(halves.experiment);
    if (!is_complete) return interrupted(store, halves, options);
    if (has_failures || !are_valid(store, halves)) {
        print_error("the better reference is not whole or not valid: '" + improved.experiment +
                    "' keeps the one that it has");
        return kExitSomeFailed;
    }
    store.put_experiment(improved);
    store.measure(improved);
    store_comparisons(store, improved);
    print_note(
        "`misbench run` goes back to the reference of its file; then this command brings the "
        "better one back without rendering it again");
    return print_outcome(store, improved);
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
    if (scenes.empty()) {
        print_note("no reference is too noisy; --all improves those of all scenes");
        return 0;
    }
    init_log("misbench", "info");
    RunOptions run = options.run;
    run.command_line =
        fmt::format("misbench reference {} --experiment {} --improve {}{}", run.store,
                    plan.experiment, *options.improve, options.all ? " --all" : "");
    return improve(run, with_better_references(plan, scenes, *options.improve), scenes);
}

}  // namespace misbench
