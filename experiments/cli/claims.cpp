// misbench claims: what became of the claims of the experiments in a store.
#include <algorithm>

#include "experiments/cli/output.h"
#include "experiments/cli/verbs.h"
#include "experiments/report/claims_formats.h"

namespace misbench {

int claims_verb(const ClaimsOptions& options) {
    const Store store(options.store, Store::Access::ReadOnly);
    std::vector<std::string> names{options.experiment};
    if (options.experiment.empty()) {
        names = store.experiments();
        std::ranges::sort(names);
    }
    std::vector<ExperimentFindings> experiments;
    for (const std::string& name : names) {
        const Plan plan = store.experiment(name);
        if (!plan.claims.empty()) experiments.push_back({name, judge_claims(store, plan)});
    }
    if (experiments.empty()) print_note("no experiment here makes a claim");
    if (options.format == "csv") {
        print_result(claims_to_csv(experiments));
    } else if (options.format == "json") {
        print_result(claims_to_json(experiments));
    } else if (options.format == "markdown") {
        print_result(claims_to_markdown(experiments));
    } else {
        print_result(claims_to_text(experiments));
    }
    return 0;
}

}  // namespace misbench
