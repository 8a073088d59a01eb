// misbench bias: which method is biased where.
#include "experiments/analysis/bias.h"

#include <filesystem>

#include "experiments/cli/output.h"
#include "experiments/cli/verbs.h"
#include "experiments/report/bias_formats.h"
#include "experiments/report/table_formats.h"
#include "renderer/base/files.h"

namespace misbench {
namespace {

// Labels are the user's and may hold what a file name must not.
std::string file_name_of(const std::string& text) {
    std::string name;
    for (const char c : text) {
        const bool is_plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') ||
                              (c >= 'a' && c <= 'z') || c == '.' || c == '_' || c == '-';
        name += is_plain ? c : '_';
    }
    return name;
}

void write_maps(const Bias& bias, const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    for (const BiasCell& cell : bias.cells) {
        if (!cell.test) continue;
        const std::string name = file_name_of(cell.scene) + "-" + file_name_of(cell.method);
        write_file_durably(folder / (name + ".png"),
                           encode_png(bias_map(cell, cell.test->scales.front()), 0));
    }
}

}  // namespace

int bias_verb(const BiasVerbOptions& options) {
    const Store store(options.store, Store::Access::ReadOnly);
    const Bias bias = find_bias(store, store.experiment(options.experiment),
                                {.against = options.against,
                                 .budget = options.budget,
                                 .margin = options.margin,
                                 .alpha = options.alpha});
    if (!options.maps.empty()) write_maps(bias, options.maps);
    if (options.format == "csv") {
        print_result(bias_to_csv(bias));
    } else if (options.format == "json") {
        print_result(bias_to_json(bias));
    } else if (options.format == "markdown") {
        print_result(to_markdown(bias_table(bias)));
    } else {
        print_result(to_text(bias_table(bias)));
    }
    return 0;
}

}  // namespace misbench
