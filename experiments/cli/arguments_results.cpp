// misbench: the syntax of the verbs that ask a store what came out.
#include <iterator>
#include <memory>

#include "experiments/cli/arguments.h"
#include "experiments/cli/verbs.h"
#include "experiments/report/table.h"

namespace misbench {
namespace {

void add_table(CLI::App& app, Chosen& chosen) {
    const auto options = std::make_shared<TableOptions>();
    CLI::App& verb =
        add_verb(app, "table", "print what an experiment says", table_verb, options, chosen);
    verb.add_option("store", options->store, "results store")->required();
    verb.add_option("--experiment", options->experiments,
                    "its name, also several times; default: the latest")
        ->allow_extra_args(false);
    verb.add_option("--metric", options->metrics,
                    "its id, also several times; METRIC*cpu, 1/(METRIC*cpu), tail(METRIC), "
                    "seconds_per_pass, passes, cpu_seconds, wall_seconds, rays; default: the "
                    "experiment's first")
        ->allow_extra_args(false);
    verb.add_option("--rows", options->rows,
                    "what goes down: scene, method, budget, metric, experiment or a parameter")
        ->capture_default_str();
    verb.add_option("--cols", options->columns, "what goes across; what is left makes further rows")
        ->capture_default_str();
    verb.add_option("--where", options->where,
                    "the seeds it is about: 'scene~veach and (budget=30s or method!=path)'");
    verb.add_option("--ratio-to", options->ratio_to,
                    "a method, best or none; default: the experiment's baseline");
    verb.add_option("--sort", options->sort, "rows by name, mean or a column; default: as planned");
    verb.add_flag(
        "--mean", options->mean,
        "also geometric means of ratios over the scenes: for just these, and for others like "
        "them");
    verb.add_flag("--group", options->group,
                  "the same of each group of scenes: what stands before the first / of a name");
    verb.add_option("--hide", options->hidden, "any of mean, ratio, seeds, effort, footer")
        ->allow_extra_args(false)
        ->delimiter(',')
        ->check(
            CLI::IsMember(std::vector<std::string>(std::begin(kHideable), std::end(kHideable))));
    verb.add_option("--precision", options->digits,
                    "significant digits; default: as many as the interval supports")
        ->check(CLI::Range(1, 17));
    verb.add_option("--format", options->format,
                    "text, latex, markdown or html; csv and json list every cell in full "
                    "precision; latex-macros has a macro for each number")
        ->check(CLI::IsMember({"text", "csv", "json", "latex", "latex-macros", "markdown", "html"}))
        ->capture_default_str();
}

void add_sql(CLI::App& app, Chosen& chosen) {
    const auto options = std::make_shared<SqlOptions>();
    CLI::App& verb =
        add_verb(app, "sql", "ask a store in SQL; read only", sql_verb, options, chosen);
    verb.add_option("store", options->store, "results store")->required();
    verb.add_option("query", options->query, "one SELECT; without it, what there is to ask");
    verb.add_option("--format", options->format, "text, csv, json or markdown")
        ->check(CLI::IsMember({"text", "csv", "json", "markdown"}))
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

void add_compare(CLI::App& app, Chosen& chosen) {
    const auto options = std::make_shared<CompareOptions>();
    CLI::App& verb = add_verb(app, "compare", "measure image files against a reference; no store",
                              compare_verb, options, chosen);
    verb.add_option("images", options->images, "EXR, PFM or HDR; PNG, JPEG, TGA or BMP as sRGB")
        ->required();
    verb.add_option("--reference", options->reference, "the image to compare with")->required();
    verb.add_option("--reference-b", options->reference_b,
                    "another of independent samples: noise of both cancels in squared errors");
    verb.add_option("--metric", options->metrics, "its id, one an option; default: a choice")
        ->allow_extra_args(false);
    verb.add_option("--format", options->format, "text, csv, json or markdown")
        ->check(CLI::IsMember({"text", "csv", "json", "markdown"}))
        ->capture_default_str();
    verb.add_option("--map", options->map, "write the metric of each pixel: .exr or .png");
    verb.add_option("--layer", options->layer, "of EXR files that have layers: its name");
}

void add_bias(CLI::App& app, Chosen& chosen) {
    const auto options = std::make_shared<BiasVerbOptions>();
    CLI::App& verb =
        add_verb(app, "bias", "print which method is biased where", bias_verb, options, chosen);
    verb.add_option("store", options->store, "results store")->required();
    verb.add_option("--experiment", options->experiment, "its name; default: the latest");
    verb.add_option("--against", options->against,
                    "the method that is taken for unbiased; default: the baseline");
    verb.add_option("--budget", options->budget, "as in tables, \"16 spp\"; default: the last");
    verb.add_option("--margin", options->margin, "of equivalence, relative to the mean")
        ->check(CLI::Range(1e-6, 0.99))
        ->capture_default_str();
    verb.add_option("--alpha", options->alpha, "rate of false findings")
        ->check(CLI::Range(1e-9, 0.5))
        ->capture_default_str();
    verb.add_option("--format", options->format, "text, csv, json or markdown")
        ->check(CLI::IsMember({"text", "csv", "json", "markdown"}))
        ->capture_default_str();
    verb.add_option("--maps", options->maps,
                    "folder for an image a scene and method: red is too bright, blue too dark");
}

void add_selftest(CLI::App& app, Chosen& chosen) {
    const auto options = std::make_shared<SelfTestOptions>();
    CLI::App& verb =
        add_verb(app, "selftest", "compare each method with itself, and with a planted difference",
                 selftest_verb, options, chosen);
    verb.add_option("store", options->store, "results store")->required();
    verb.add_option("--experiment", options->experiment, "its name; default: the latest");
    verb.add_option("--metric", options->metric, "its id; default: the experiment's first");
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
                        "render so many times the samples where a reference is too noisy")
            ->check(CLI::Range(2, 1000));
    verb.add_flag("--all", options->all, "of all scenes")->needs(improve);
    verb.add_option("--workers", options->run.workers, "worker processes")
        ->check(CLI::Range(1, 1024))
        ->capture_default_str();
    verb.add_option("--threads-per-worker", options->run.threads_per_worker,
                    "render threads of each")
        ->check(CLI::Range(1, 4096))
        ->capture_default_str();
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
    add_compare(app, chosen);
    add_sql(app, chosen);
    add_bias(app, chosen);
    add_selftest(app, chosen);
    add_diff(app, chosen);
    add_explain(app, chosen);
    add_tradeoff(app, chosen);
    add_reference(app, chosen);
    add_figure(app, chosen);
}

}  // namespace misbench
