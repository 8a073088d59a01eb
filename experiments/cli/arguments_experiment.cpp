// misbench: the syntax of the verbs that read experiment files.
#include <memory>

#include "experiments/cli/arguments.h"
#include "experiments/cli/verbs.h"

namespace misbench {
namespace {

void add_experiment(CLI::App& verb, ExperimentOptions& experiment) {
    verb.add_option("--profile", experiment.profile,
                    "one of the file's profiles; default: its first");
    verb.add_option("--set", experiment.overrides,
                    "PATH=VALUE: override a value of the file, as in methods.pt.max_depth=3")
        ->allow_extra_args(false);
    add_scenes(verb, experiment.scenes);
}

void add_plan(CLI::App& app, Chosen& chosen) {
    const auto options = std::make_shared<PlanOptions>();
    CLI::App& verb = add_verb(app, "plan",
                              "show the tasks of an experiment, which are done, and "
                              "the time that the others will take",
                              plan_verb, options, chosen);
    verb.add_option("file", options->file, "experiment file (YAML)")->required();
    add_experiment(verb, options->experiment);
    verb.add_option("--store", options->store, "results store to look for finished tasks");
    verb.add_flag("--json", options->json, "as JSON");
}

void add_run(CLI::App& app, Chosen& chosen, const std::string& command_line) {
    const auto options = std::make_shared<RunOptions>();
    options->command_line = command_line;
    CLI::App& verb = add_verb(app, "run",
                              "run experiments and print their tables and claims; a "
                              "second call resumes",
                              run_verb, options, chosen);
    verb.add_option("files", options->files, "experiment files (YAML), run one after the other")
        ->required();
    add_experiment(verb, options->experiment);
    verb.add_option("--store", options->store, "results store; made if it is not there")
        ->required();
    verb.add_option("--workers", options->workers, "worker processes")
        ->check(CLI::Range(1, 1024))
        ->capture_default_str();
    verb.add_option("--threads-per-worker", options->threads_per_worker, "render threads of each")
        ->check(CLI::Range(1, 4096))
        ->capture_default_str();
    verb.add_option("--progress", options->progress,
                    "a line in place: auto (on a terminal), always, never")
        ->check(CLI::IsMember({"auto", "always", "never"}))
        ->capture_default_str();
}

}  // namespace

void add_experiment_verbs(CLI::App& app, Chosen& chosen, const std::string& command_line) {
    add_plan(app, chosen);
    add_run(app, chosen, command_line);
}

}  // namespace misbench
