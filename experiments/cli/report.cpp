// misbench report: the experiment as one HTML file.
#include "experiments/report/report.h"

#include <filesystem>

#include "experiments/cli/output.h"
#include "experiments/cli/verbs.h"
#include "renderer/base/files.h"

namespace misbench {

int report_verb(const ReportOptions& options) {
    const Store store(options.store, Store::Access::ReadOnly);
    const Plan plan = store.experiment(options.experiment);
    const std::filesystem::path output = options.output.empty()
                                             ? store.folder() / "report.html"
                                             : std::filesystem::path(options.output);
    write_file_durably(output, make_report(store, plan));
    print_note("wrote " + output.string());
    return 0;
}

}  // namespace misbench
