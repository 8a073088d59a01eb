#include "results/merge.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "experiments/plan/unite.h"
#include "renderer/base/error.h"
#include "results/run_directory.h"
#include "results/store.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;

using Plans = std::map<std::string, Plan>;

std::vector<Plan> plans_of(const Store& store) {
    std::vector<Plan> plans;
    for (const std::string& name : store.experiments()) plans.push_back(store.experiment(name));
    // The oldest first, as they came.
    std::ranges::reverse(plans);
    return plans;
}

// The next name that is free or has the same plan already.
std::string other_name(const Plans& plans, Plan plan) {
    const std::string name = plan.experiment;
    for (int n = 2;; ++n) {
        plan.experiment = name + "-" + std::to_string(n);
        const auto there = plans.find(plan.experiment);
        if (there == plans.end() || !what_differs(there->second, plan)) return plan.experiment;
    }
}

// Puts a plan among the others. Pure; `source` is for the message.
void add_plan(Plans& plans, Plan plan, const fs::path& source, bool rename) {
    auto there = plans.find(plan.experiment);
    if (there != plans.end()) {
        if (const auto difference = what_differs(there->second, plan)) {
            if (!rename) {
                throw Error(Errc::InvalidArgument,
                            "merge '" + source.string() + "': experiment '" + plan.experiment +
                                "' is another one there: " + *difference + "; --rename keeps both");
            }
            plan.experiment = other_name(plans, plan);
            there = plans.find(plan.experiment);
        }
    }
    if (there == plans.end()) {
        plans.emplace(plan.experiment, std::move(plan));
    } else if (there->second != plan) {
        there->second = unite(there->second, plan);
    }
}

void copy_run(Store& into, const Store& from, const std::string& id, Merged& merged) {
    if (into.has_run(id)) {
        ++merged.n_known;
        const bool is_same = into.run(id)->image_sha256 == from.run(id)->image_sha256;
        if (!is_same && into.run_image(id) != from.run_image(id)) {
            merged.other_images.push_back(id);
        }
        return;
    }
    const fs::path staged = into.stage(id, 0);
    std::error_code error;
    fs::copy(from.run_folder(id), staged, fs::copy_options::recursive, error);
    if (error) {
        throw Error(Errc::DataLoss,
                    "merge run " + id + " of '" + from.folder().string() + "': " + error.message());
    }
    if (into.commit_run(staged) == Recorded::New) ++merged.n_runs;
}

}  // namespace

Merged merge_stores(const fs::path& into, const std::vector<fs::path>& from, bool rename) {
    std::vector<Store> sources;
    for (const fs::path& source : from) {
        std::error_code ignored;
        if (fs::equivalent(into, source, ignored)) {
            throw Error(Errc::InvalidArgument,
                        "merge '" + source.string() + "': it is the store to merge into");
        }
        sources.emplace_back(source, Store::Access::ReadOnly);
    }
    const auto united = [&](Plans plans) {
        for (const Store& source : sources) {
            for (const Plan& plan : plans_of(source)) {
                add_plan(plans, plan, source.folder(), rename);
            }
        }
        return plans;
    };
    // What cannot be united by itself makes no store.
    if (!fs::exists(into)) united({});
    Store store(into, Store::Access::ReadWrite);
    Plans before;
    for (Plan& plan : plans_of(store)) before.emplace(plan.experiment, std::move(plan));
    const Plans plans = united(before);

    Merged merged;
    for (const Store& source : sources) {
        for (const auto& [id, summary] : source.run_summaries()) {
            copy_run(store, source, id, merged);
        }
    }
    for (const auto& [name, plan] : plans) {
        const auto there = before.find(name);
        if (there == before.end() || there->second != plan) {
            store.put_experiment(plan);
            merged.experiments.push_back(name);
        }
        merged.n_measured += store.measure(plan);
    }
    return merged;
}

}  // namespace misbench
