// misbench: the syntax of the verbs that ask a store what came out.
#include <memory>

#include "experiments/cli/arguments.h"
#include "experiments/cli/verbs.h"

namespace misbench {
namespace {

void add_table(CLI::App& app, Chosen& chosen) {
    const auto options = std::make_shared<TableOptions>();
    CLI::App& verb =
        add_verb(app, "table", "print what an experiment says", table_verb, options, chosen);
    verb.add_option("store", options->store, "results store")->required();
    verb.add_option("--experiment", options->experiment, "its name; default: the latest");
    verb.add_option("--metric", options->metric, "its id; default: the experiment's first");
    const CLI::IsMember is_axis({"scene", "method", "budget"});
    verb.add_option("--rows", options->rows, "what goes down: scene, method or budget")
        ->check(is_axis)
        ->capture_default_str();
    verb.add_option("--cols", options->columns, "what goes across; the third makes further rows")
        ->check(is_axis)
        ->capture_default_str();
    verb.add_option("--format", options->format,
                    "text, latex or markdown; csv and json list every cell in full precision")
        ->check(CLI::IsMember({"text", "csv", "json", "latex", "markdown"}))
        ->capture_default_str();
}

void add_claims(CLI::App& app, Chosen& chosen) {
    const auto options = std::make_shared<ClaimsOptions>();
    CLI::App& verb = add_verb(app, "claims", "print what became of the claims of experiments",
                              claims_verb, options, chosen);
    verb.add_option("store", options->store, "results store")->required();
    verb.add_option("--experiment", options->experiment, "its name; default: all of the store");
    verb.add_option("--format", options->format, "text, csv, json or markdown")
        ->check(CLI::IsMember({"text", "csv", "json", "markdown"}))
        ->capture_default_str();
}

void add_report(CLI::App& app, Chosen& chosen) {
    const auto options = std::make_shared<ReportOptions>();
    CLI::App& verb = add_verb(app, "report", "write the tables and images as one HTML file",
                              report_verb, options, chosen);
    verb.add_option("store", options->store, "results store")->required();
    verb.add_option("--experiment", options->experiment, "its name; default: the latest");
    verb.add_option("-o,--output", options->output, "default: STORE/report.html");
}

void add_figure(CLI::App& app, Chosen& chosen) {
    const auto options = std::make_shared<FigureOptions>();
    CLI::App& verb =
        add_verb(app, "figure", "draw a figure of a paper", figure_verb, options, chosen);
    verb.add_option("file", options->file, "what it shows (YAML)")->required();
    verb.add_option("--store", options->store, "results store")->required();
    verb.add_option("--experiment", options->experiment, "in place of the file's");
    verb.add_option("-o,--output", options->output,
                    "by its extension PDF, SVG, PNG, TikZ (.tex, with PNG files beside) or HTML")
        ->required();
}

}  // namespace

void add_result_verbs(CLI::App& app, Chosen& chosen) {
    add_table(app, chosen);
    add_claims(app, chosen);
    add_report(app, chosen);
    add_figure(app, chosen);
}

}  // namespace misbench
