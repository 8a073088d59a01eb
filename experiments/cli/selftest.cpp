// misbench selftest: does the comparison find a difference where there is none, and one that is?
#include <fmt/format.h>

#include <algorithm>

#include "experiments/analysis/self_test.h"
#include "experiments/cli/output.h"
#include "experiments/cli/verbs.h"

namespace misbench {
namespace {

constexpr std::size_t kShownSkipped = 3;

std::string percent(double share) { return fmt::format("{:.1f} %", 100 * share); }

std::string tested_line(const std::string& what, const TestedShare& tested) {
    return fmt::format("  {:<34} {:>6}  [{}, {}]\n", what, percent(tested.share),
                       percent(tested.interval.low), percent(tested.interval.high));
}

std::string to_text(const SelfTest& test) {
    std::string text = fmt::format(
        "self-test of {}, {}: the seeds of each method split at random into two halves, {} times\n",
        test.experiment, test.metric, kSplits);
    for (std::size_t i = 0; i < std::min(test.skipped.size(), kShownSkipped); ++i) {
        text += fmt::format("  left out: {}; {} are needed\n", test.skipped[i], kFewestToSplit);
    }
    if (test.skipped.size() > kShownSkipped) {
        text += fmt::format("  left out: {} more\n", test.skipped.size() - kShownSkipped);
    }
    if (test.cells.empty()) {
        return text + fmt::format(
                          "nothing is tested: no method has {} measured seeds; raise the "
                          "experiment's seeds and run it again\n",
                          kFewestToSplit);
    }
    text += fmt::format("\nhalves that are the same, found different (at most {} wanted):\n",
                        percent(test.alpha));
    text += tested_line("each alone", test.alone);
    text += tested_line("adjusted for the table", test.adjusted);
    text += fmt::format(
        "  {}\n", test.passes()
                      ? fmt::format("no more than chance, as far as {} cells tell: the comparison "
                                    "passes",
                                    test.cells.size())
                      : "MORE THAN CHANCE: intervals here are too short; see tails");
    text += fmt::format("\na planted difference of {:.0f} %, found by halves of the seeds:\n",
                        100 * kPlanted);
    text += fmt::format("  {:<34} {:>6}\n", "each alone", percent(test.found_alone));
    text += fmt::format("  {:<34} {:>6}\n\n", "adjusted, the only one of its table",
                        percent(test.found_adjusted));
    std::vector<std::vector<std::string>> rows{{"scene", "method", "budget", "seeds",
                                                "found where none is", "found by halves",
                                                "power at all seeds", "seeds for power 80 %"}};
    for (const SplitCell& cell : test.cells) {
        rows.push_back({cell.scene, cell.method, to_string(cell.budget),
                        std::to_string(cell.n_seeds), percent(cell.false_share),
                        percent(cell.found_share), percent(cell.power),
                        cell.n_needed ? std::to_string(*cell.n_needed)
                                      : fmt::format("> {}", kMostSeedsForPower)});
    }
    return text + align(rows) +
           "\nintervals as if each cell had been split once; power is of independent seeds and of "
           "one cell alone:\npairs of correlated errors find more\n";
}

}  // namespace

int selftest_verb(const SelfTestOptions& options) {
    const Store store(options.store, Store::Access::ReadOnly);
    const Plan plan = store.experiment(options.experiment);
    const SelfTest test = self_test(compare(store, plan, options.metric));
    print_result(to_text(test));
    return test.cells.empty() || !test.passes() ? kExitSomeFailed : 0;
}

}  // namespace misbench
