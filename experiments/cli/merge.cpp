// misbench merge: several stores as one.
#include <fmt/format.h>

#include "experiments/cli/output.h"
#include "experiments/cli/verbs.h"
#include "renderer/base/log.h"
#include "results/merge.h"

namespace misbench {

int merge_verb(const MergeOptions& options) {
    init_log("misbench", "warn");
    const Merged merged =
        merge_stores(options.store, {options.from.begin(), options.from.end()}, options.rename);
    if (!merged.other_images.empty()) {
        print_note(
            fmt::format("{} runs are in both with other images, the first is kept; "
                        "`misbench diff` says which",
                        merged.other_images.size()));
    }
    print_result(fmt::format(
        "{} runs copied, {} there before, {} errors measured; experiments that came or grew: {}\n",
        merged.n_runs, merged.n_known, merged.n_measured,
        merged.experiments.empty() ? "none"
                                   : fmt::format("{}", fmt::join(merged.experiments, " "))));
    return 0;
}

}  // namespace misbench
