// misbench table: what an experiment says.
#include "experiments/analysis/comparison.h"
#include "experiments/cli/output.h"
#include "experiments/cli/verbs.h"
#include "experiments/report/provenance.h"
#include "experiments/report/table_formats.h"
#include "renderer/base/error.h"

namespace misbench {

int table_verb(const TableOptions& options) {
    const Store store(options.store, Store::Access::ReadOnly);
    const Plan plan = store.experiment(options.experiment);
    const Comparison comparison = compare(store, plan, options.metric);
    if (options.format == "csv") {
        print_result(to_csv(comparison));
        return 0;
    }
    if (options.format == "json") {
        print_result(to_json(comparison));
        return 0;
    }
    const TableLayout layout{.rows = axis_from_string(options.rows),
                             .columns = axis_from_string(options.columns)};
    const Table table = make_table(comparison, layout, provenance_lines(store, plan));
    if (options.format == "latex") {
        print_result(to_latex(table));
    } else if (options.format == "markdown") {
        print_result(to_markdown(table));
    } else {
        print_result(to_text(table));
    }
    return 0;
}

}  // namespace misbench
