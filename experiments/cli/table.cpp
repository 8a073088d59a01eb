// misbench table: what experiments say.
#include <algorithm>

#include "experiments/analysis/comparison.h"
#include "experiments/analysis/scene_means.h"
#include "experiments/cli/output.h"
#include "experiments/cli/verbs.h"
#include "experiments/report/provenance.h"
#include "experiments/report/table_formats.h"
#include "renderer/base/error.h"
#include "results/rollup.h"

namespace misbench {
namespace {

// One for each experiment and metric that is asked for.
std::vector<Comparison> comparisons_of(const Store& store, const TableOptions& options,
                                       const std::vector<Plan>& plans) {
    const std::vector<std::string> metrics =
        options.metrics.empty() ? std::vector<std::string>{""} : options.metrics;
    std::vector<Comparison> comparisons;
    for (const Plan& plan : plans) {
        for (const std::string& metric : metrics) {
            comparisons.push_back(compare(store, plan,
                                          {.quantity = metric,
                                           .budget = std::nullopt,
                                           .ratio_to = options.ratio_to,
                                           .where = options.where}));
            if (options.mean || options.group) {
                add_means_over_scenes(comparisons.back(), options.group);
            }
        }
    }
    // Ratios to the best of the same runs are no tests.
    if (options.ratio_to != kToBest) adjust_p_values(comparisons);
    return comparisons;
}

std::string formatted(const Table& table, const std::string& format) {
    if (format == "latex") return to_latex(table);
    if (format == "markdown") return to_markdown(table);
    if (format == "html") return to_html(table);
    return to_text(table);
}

}  // namespace

int table_verb(const TableOptions& options) {
    roll_up_if_left_without(options.store);
    const Store store(options.store, Store::Access::ReadOnly);
    std::vector<Plan> plans;
    for (const std::string& name : options.experiments) {
        plans.push_back(store.experiment_head(name));
    }
    if (plans.empty()) plans.push_back(store.experiment_head(""));
    const std::vector<Comparison> comparisons = comparisons_of(store, options, plans);
    if (std::ranges::all_of(comparisons, [](const auto& c) { return c.cells.empty(); })) {
        throw Error(Errc::InvalidArgument,
                    options.where.empty()
                        ? "make a table: experiment '" + plans[0].experiment + "' has no methods"
                        : "make a table: no seed matches '" + options.where + "'");
    }
    if (options.format == "csv") {
        print_result(to_csv(comparisons));
    } else if (options.format == "json") {
        print_result(to_json(comparisons));
    } else if (options.format == "latex-macros") {
        print_result(to_latex_macros(comparisons, options.digits));
    } else {
        std::vector<std::string> provenance;
        for (const Plan& plan : plans) {
            for (std::string& line : provenance_lines(store, plan.experiment)) {
                provenance.push_back(std::move(line));
            }
        }
        const TableLayout layout{.rows = options.rows,
                                 .columns = options.columns,
                                 .sort = options.sort,
                                 .hidden = {options.hidden.begin(), options.hidden.end()},
                                 .digits = options.digits};
        print_result(formatted(make_table(comparisons, layout, provenance), options.format));
    }
    return 0;
}

}  // namespace misbench
