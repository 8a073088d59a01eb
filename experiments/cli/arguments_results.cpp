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

void add_tradeoff(CLI::App& app, Chosen& chosen) {
    const auto options = std::make_shared<TradeoffOptions>();
    CLI::App& verb =
        add_verb(app, "tradeoff", "print what accuracy costs", tradeoff_verb, options, chosen);
    verb.add_option("store", options->store, "results store")->required();
    verb.add_option("--experiment", options->experiment, "its name; default: the latest");
    verb.add_option("--x", options->x,
                    "cost (CPU seconds), wall, passes, or a parameter in which methods differ")
        ->capture_default_str();
    verb.add_option("--y", options->y,
                    "a metric, or its id up to a dot; default: the experiment's first");
    verb.add_option("--scene", options->scene, "default: all");
    verb.add_option("--against", options->against, "a method; default: the baseline");
    verb.add_option("--target", options->target,
                    "the error to reach; default: the baseline's at its last effort")
        ->check(CLI::PositiveNumber);
    verb.add_option("--format", options->format, "text, csv, json or markdown")
        ->check(CLI::IsMember({"text", "csv", "json", "markdown"}))
        ->capture_default_str();
}

void add_reference(CLI::App& app, Chosen& chosen) {
    const auto options = std::make_shared<ReferenceOptions>();
    CLI::App& verb =
        add_verb(app, "reference", "print how noisy the references are, or improve them",
                 reference_verb, options, chosen);
    verb.add_option("store", options->run.store, "results store")->required();
    verb.add_option("--experiment", options->experiment, "its name; default: the latest");
    CLI::Option* improve =
        verb.add_option("--improve", options->improve,
                        "render so many times the samples where a reference is too noisy; 1 goes "
                        "on where that was interrupted")
            ->check(CLI::Range(1, 1000));
    verb.add_flag("--all", options->all, "of all scenes")->needs(improve);
    verb.add_option("--workers", options->run.workers, "worker processes")
        ->check(CLI::Range(1, 1024))
        ->capture_default_str();
    verb.add_option("--threads-per-worker", options->run.threads_per_worker,
                    "render threads of each")
        ->check(CLI::Range(1, 4096))
        ->capture_default_str();
}

}  // namespace

void add_result_verbs(CLI::App& app, Chosen& chosen) {
    add_table(app, chosen);
    add_claims(app, chosen);
    add_report(app, chosen);
    add_tradeoff(app, chosen);
    add_reference(app, chosen);
}

}  // namespace misbench
