// misbench run: experiments from their files to their tables, with a coordinator and workers of
// their own.
#include <fmt/format.h>

#include <algorithm>

#include "experiments/analysis/comparison.h"
#include "experiments/analysis/seed_rounds.h"
#include "experiments/cli/local_run.h"
#include "experiments/cli/output.h"
#include "experiments/cli/progress.h"
#include "experiments/cli/verbs.h"
#include "experiments/resolve.h"
#include "experiments/scene_lookup.h"
#include "renderer/base/error.h"
#include "renderer/base/log.h"

namespace misbench {
namespace {

// All plans before the first task: what is wrong with the last file is said now, not after hours.
std::vector<Plan> resolve_all(const RunOptions& options) {
    const ExperimentOptions& from = options.experiment;
    const std::filesystem::path scenes = scene_folder(from.scenes);
    std::vector<Plan> plans;
    for (const std::string& file : options.files) {
        if (options.files.size() > 1 && is_lab_file(file)) {
            print_note("passed over '" + file + "': a file for `misbench lab`");
            continue;
        }
        plans.push_back(resolve(read_experiment_yaml(file, from.overrides, from.profile), scenes));
        const std::string& name = plans.back().experiment;
        if (std::ranges::count(plans, name, &Plan::experiment) > 1) {
            throw Error(Errc::InvalidArgument,
                        file + ": a second experiment of the name '" + name + "'");
        }
    }
    if (plans.empty()) {
        throw Error(Errc::InvalidArgument, "run experiments: all files are for `misbench lab`");
    }
    return plans;
}

// Round by round where the experiment has a seed rule, else all at once. A round has a fleet of its
// own, which costs it about three seconds and the loading of its scenes.
int run_plan(const RunOptions& options, const Plan& largest) {
    Plan plan = first_round(largest);
    std::string progress;
    for (int round = 1;; ++round) {
        const bool is_complete = do_tasks(options, plan, progress);
        Store store(options.store, Store::Access::ReadWrite);
        // With the images that were imported into it.
        const Plan stored = store.experiment(plan.experiment);
        store.measure(stored);
        if (!is_complete) return interrupted(store, plan, options);
        const Comparison comparison = compare(store, stored);
        std::optional<Plan> next = next_round(largest, comparison);
        if (!next) {
            store_comparisons(store, stored);
            return print_outcome(store, stored);
        }
        const RuleOutcome outcome = outcome_of_rule(comparison);
        const std::size_t n_wide = outcome.n_ratios() - outcome.n_narrow;
        const std::size_t n_further = next->cells.size() - plan.cells.size();
        progress =
            fmt::format("round {}, {} of {} ratios wide: ", round + 1, n_wide, outcome.n_ratios());
        if (progress_mode(options.progress) != ProgressMode::Never) {
            spdlog::info("round ended round={} ratios={} wide={} further_runs={}", round,
                         outcome.n_ratios(), n_wide, n_further);
        }
        plan = std::move(*next);
    }
}

}  // namespace

int run_verb(const RunOptions& options) {
    init_log("misbench", "info");
    const std::vector<Plan> plans = resolve_all(options);
    int worst = 0;
    for (const Plan& plan : plans) {
        if (&plan != &plans.front()) print_result("\n");
        worst = std::max(worst, run_plan(options, plan));
        if (worst == kExitInterrupted) break;
    }
    return worst;
}

}  // namespace misbench
