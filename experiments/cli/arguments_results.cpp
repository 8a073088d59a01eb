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

void add_diff(CLI::App& app, Chosen& chosen) {
    const auto options = std::make_shared<DiffOptions>();
    CLI::App& verb = add_verb(app, "diff", "say how two stores differ; exit code 1 when they do",
                              diff_verb, options, chosen);
    verb.add_option("a", options->a, "results store")->required();
    verb.add_option("b", options->b, "results store")->required();
    verb.add_option("--experiment", options->experiment, "its name; default: all of them");
    verb.add_option("--metric", options->metric, "its id; default: each experiment's first");
    verb.add_flag("--json", options->json, "as JSON");
}

void add_explain(CLI::App& app, Chosen& chosen) {
    const auto options = std::make_shared<ExplainOptions>();
    CLI::App& verb = add_verb(app, "explain",
                              "say what a run is made of, or why an experiment's tasks are or are "
                              "not in the store",
                              explain_verb, options, chosen);
    verb.add_option("store", options->store, "results store")->required();
    verb.add_option("run", options->run, "id of a run or task, or the beginning of it");
    verb.add_option("--experiment", options->file, "experiment file (YAML)");
    verb.add_option("--profile", options->experiment.profile, "of the file; default: its first");
    verb.add_option("--set", options->experiment.overrides, "PATH=VALUE in the file")
        ->allow_extra_args(false);
    verb.add_option("--scene", options->scene, "only this scene");
    verb.add_option("--method", options->method, "only this label");
    verb.add_option("--seed", options->seed, "only this seed");
    add_scenes(verb, options->experiment.scenes);
}

}  // namespace

void add_result_verbs(CLI::App& app, Chosen& chosen) {
    add_table(app, chosen);
    add_claims(app, chosen);
    add_report(app, chosen);
    add_diff(app, chosen);
    add_explain(app, chosen);
}

}  // namespace misbench
