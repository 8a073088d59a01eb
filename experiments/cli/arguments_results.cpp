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
    verb.add_option("--seeds", options->seeds,
                    "images beside the means over seeds: none, of the first seed, of all")
        ->check(CLI::IsMember({"none", "first", "all"}))
        ->capture_default_str();
    verb.add_flag("--full-precision", options->full_precision,
                  "keep pixels as floats, not as half floats: twice as large");
    CLI::Option* watch = verb.add_flag("--watch", options->watch,
                                       "write it again whenever the store changes, until all runs "
                                       "are done; the page loads itself again meanwhile");
    verb.add_option("--interval", options->interval_seconds, "seconds between two looks")
        ->check(CLI::Range(0.1, 3600.0))
        ->capture_default_str()
        ->needs(watch);
}

}  // namespace

void add_result_verbs(CLI::App& app, Chosen& chosen) {
    add_table(app, chosen);
    add_claims(app, chosen);
    add_report(app, chosen);
}

}  // namespace misbench
