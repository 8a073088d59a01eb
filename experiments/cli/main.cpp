// misbench, the command line tool. Only this file knows CLI11 (it costs seconds to compile): it
// turns a command line into the options of a verb (verbs.h) and an Error into an exit code.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <memory>
#include <new>
#include <thread>

#include "experiments/cli/output.h"
#include "experiments/cli/verbs.h"
#include "experiments/plan/suggestion.h"
#include "renderer/base/build_info.h"
#include "renderer/base/error.h"

namespace misbench {
namespace {

using Chosen = std::function<int()>;

// A subcommand that, when it is the one, makes `chosen` call `verb` with its options.
template <typename Options>
CLI::App& add_verb(CLI::App& app, const std::string& name, const std::string& help,
                   int (*verb)(const Options&), const std::shared_ptr<Options>& options,
                   Chosen& chosen) {
    CLI::App* command = app.add_subcommand(name, help);
    command->callback([&chosen, verb, options] { chosen = [=] { return verb(*options); }; });
    return *command;
}

void add_scenes(CLI::App& verb, std::string& scenes) {
    verb.add_option("--scenes", scenes, "folder in which scenes are found by name");
}

void add_experiment(CLI::App& verb, ExperimentOptions& experiment) {
    verb.add_option("--profile", experiment.profile,
                    "one of the file's profiles; default: its first");
    verb.add_option("--set", experiment.overrides,
                    "PATH=VALUE: override a value of the file, as in methods.pt.max_depth=3")
        ->allow_extra_args(false);
    add_scenes(verb, experiment.scenes);
}

void add_list(CLI::App& app, Chosen& chosen) {
    const auto options = std::make_shared<ListOptions>();
    CLI::App& verb = add_verb(app, "list", "show what can be written in an experiment", list_verb,
                              options, chosen);
    verb.add_option("what", options->what, "methods, heuristics, factors, metrics or scenes")
        ->required()
        ->check(CLI::IsMember({"methods", "heuristics", "factors", "metrics", "scenes"}));
    verb.add_flag("--json", options->json, "as JSON");
    add_scenes(verb, options->scenes);
}

int default_threads() {
    return static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

// All but the scene. Returns what a stored run says by itself.
std::vector<CLI::Option*> add_estimate(CLI::App& verb, EstimateOptions& estimate) {
    estimate.threads = default_threads();
    verb.add_option("--threads", estimate.threads, "render threads")
        ->check(CLI::Range(1, 4096))
        ->capture_default_str();
    add_scenes(verb, estimate.scenes);
    return {verb.add_option("--method", estimate.method, "see `misbench list methods`")
                ->capture_default_str(),
            verb.add_option("--set", estimate.parameters, "KEY=VALUE: a parameter of the method")
                ->allow_extra_args(false),
            verb.add_option("--seed", estimate.seed, "")
                ->check(CLI::NonNegativeNumber)
                ->capture_default_str(),
            verb.add_option(
                "--size", estimate.size,
                "WIDTHxHEIGHT in pixels; default: what the scene file asks for, else 640x480")};
}

void add_render(CLI::App& app, Chosen& chosen) {
    const auto options = std::make_shared<RenderOptions>();
    CLI::App& verb = add_verb(app, "render", "render a single image", render_verb, options, chosen);
    verb.add_option("scene", options->estimate.scene, "name or path of a scene")->required();
    auto* samples = verb.add_option("--spp", options->samples, "samples a pixel")
                        ->check(CLI::Range(std::int64_t{1}, std::int64_t{1'000'000'000}));
    auto* seconds = verb.add_option("--seconds", options->seconds, "or time")
                        ->check(CLI::PositiveNumber)
                        ->excludes(samples);
    verb.add_option("--clock", options->clock, "of --seconds: cpu or wall")
        ->check(CLI::IsMember({"cpu", "wall"}))
        ->needs(seconds)
        ->capture_default_str();
    add_estimate(verb, options->estimate);
    verb.add_option("-o,--output", options->output, "image.exr (linear) or image.png (sRGB)")
        ->required();
    verb.add_option("--exposure", options->exposure, "stops, for .png")->capture_default_str();
    verb.add_option(
            "--techniques", options->techniques,
            "also what each technique contributes, a bidirectional method's only: .exr with "
            "layers such as weighted.n4.connect2 and unweighted.n2.hit (path length, "
            "technique) beside the image; or .png, a row a path length, a column a "
            "technique, weighted above unweighted; prints each one's part of the image")
        ->needs(samples);
    verb.add_option("--factors", options->factors,
                    "also the factors that the method learned, by pixel: .exr with layers such as "
                    "correction.merge");
    verb.add_flag("--json", options->json, "write the run's record to stdout");
}

void add_replay(CLI::App& app, Chosen& chosen) {
    const auto options = std::make_shared<ReplayOptions>();
    CLI::App& verb =
        add_verb(app, "replay",
                 "render one sample of a pixel again and show every path in it: "
                 "vertices, densities, weights, values; of a stored run, or of a scene "
                 "and a method",
                 replay_verb, options, chosen);
    auto* run = verb.add_option("run", options->run, "id of a run, or its beginning");
    run->needs(verb.add_option("--store", options->store, "results store of the run")->needs(run));
    verb.add_option("--pixel", options->pixel,
                    "x,y from the top left, from 0; default: of the run's first bad sample");
    verb.add_option("--sample", options->sample,
                    "which of the samples a pixel, from 0; default: the bad one, else 0")
        ->check(CLI::Range(std::int64_t{0}, std::int64_t{1'000'000'000}));
    verb.add_option("--scene", options->estimate.scene,
                    "name or path of a scene; of a run, where it lies now");
    for (CLI::Option* option : add_estimate(verb, options->estimate)) option->excludes(run);
    verb.add_flag("--json", options->json, "as JSON");
}

void add_scene(CLI::App& app, Chosen& chosen) {
    CLI::App* scene = app.add_subcommand(
        "scene", "show what a scene requires (info) or what is wrong with it (check)");
    scene->require_subcommand(1);
    const auto add = [&](const std::string& name, const std::string& help,
                         int (*verb)(const SceneOptions&)) {
        const auto options = std::make_shared<SceneOptions>();
        options->threads = default_threads();
        CLI::App& command = add_verb(*scene, name, help, verb, options, chosen);
        command.add_option("--threads", options->threads, "threads that build and render")
            ->check(CLI::Range(1, 4096))
            ->capture_default_str();
        command.add_flag("--json", options->json, "as JSON");
        add_scenes(command, options->scenes);
        return command.add_option("scene", options->scene, "name or path of a scene");
    };
    add("info",
        "show what a scene requires and which methods estimate all of its light; without a name "
        "one line for every scene of the folder",
        scene_info_verb);
    add("check",
        "the same after a render of about one second, with warnings (exit code 1) of flipped "
        "emitters, missing light, a camera in geometry, degenerate, duplicate and wrongly wound "
        "triangles, wrong normals, missing uv, non-finite samples",
        scene_check_verb)
        ->required();
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

void add_store_verb(CLI::App& app, Chosen& chosen, const std::string& name, const std::string& help,
                    int (*function)(const StoreOptions&)) {
    const auto options = std::make_shared<StoreOptions>();
    CLI::App& verb = add_verb(app, name, help, function, options, chosen);
    verb.add_option("store", options->store, "results store")->required();
}

void add_lab(CLI::App& app, Chosen& chosen) {
    const auto options = std::make_shared<LabOptions>();
    CLI::App& verb = add_verb(app, "lab",
                              "try MIS weights on integrals over an interval: exact and sampled "
                              "variance, bias, weights",
                              lab_verb, options, chosen);
    verb.add_option("file", options->file, "laboratory file (YAML)")->required();
    verb.add_option("--set", options->overrides,
                    "PATH=VALUE: override a value of the file, as in runs=1000")
        ->allow_extra_args(false);
    verb.add_option("-o,--output", options->output, "FILE.svg: integrands, weights, errors");
    verb.add_option("--format", options->format, "text, json or csv")
        ->check(CLI::IsMember({"text", "json", "csv"}))
        ->capture_default_str();
}

// As a shell would take it.
std::string command_line_of(int argc, char** argv) {
    std::string line;
    for (int i = 0; i < argc; ++i) {
        const std::string argument = argv[i];
        const bool is_plain =
            !argument.empty() &&
            argument.find_first_of(" \t\n'\"\\$`*?[](){}<>|&;#~!") == std::string::npos;
        std::string quoted;
        for (const char c : argument)
            quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
        line += (i == 0 ? "" : " ") + (is_plain ? argument : "'" + quoted + "'");
    }
    return line;
}

// CLI11 would only say that a subcommand is required.
void require_known_verb(const CLI::App& app, int argc, char** argv) {
    const CLI::App* verb = &app;
    for (int i = 1; i < argc && argv[i][0] != '-'; ++i) {
        std::vector<std::string> known;
        for (const CLI::App* sub : verb->get_subcommands({})) known.push_back(sub->get_name());
        if (known.empty()) return;
        if (std::ranges::find(known, argv[i]) == known.end()) {
            throw Error(Errc::InvalidArgument, unknown_name("verb", argv[i], known));
        }
        verb = verb->get_subcommand(argv[i]);
    }
}

int run_program(int argc, char** argv) {
    CLI::App app("Compares Monte Carlo renderers: experiments, results, tables.", "misbench");
    app.set_version_flag("--version", fmt::format("misbench {} ({}, {})", build_id(),
                                                  build_compiler(), build_flags()));
    app.require_subcommand(1);
    app.footer(
        "Exit codes: 0 done, 1 some tasks failed or a scene has warnings, 2 usage, experiment\n"
        "or scene, 3 store, 4 coordinator out of reach, 70 a bug of misbench, 130 interrupted.");
    Chosen chosen;
    add_list(app, chosen);
    add_render(app, chosen);
    add_replay(app, chosen);
    add_scene(app, chosen);
    add_plan(app, chosen);
    add_run(app, chosen, command_line_of(argc, argv));
    add_table(app, chosen);
    add_claims(app, chosen);
    add_report(app, chosen);
    add_lab(app, chosen);
    add_store_verb(app, chosen, "status", "count the tasks of a store's experiments", status_verb);
    add_store_verb(app, chosen, "reindex", "rebuild a store's database from its run directories",
                   reindex_verb);
    require_known_verb(app, argc, argv);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == 0) return app.exit(e);
        print_error(std::string(e.what()) + "; see misbench --help");
        return kExitUsage;
    }
    return chosen();
}

}  // namespace
}  // namespace misbench

int main(int argc, char** argv) {
    try {
        return misbench::run_program(argc, argv);
    } catch (const misbench::Error& e) {
        misbench::print_error(e.what());
        return misbench::exit_code(e.code());
    } catch (const std::bad_alloc&) {
        misbench::print_error("out of memory: a smaller image or scene is needed");
        return misbench::exit_code(misbench::Errc::FailedPrecondition);
    } catch (const std::exception& e) {
        misbench::print_error(std::string("unexpected: ") + e.what());
        return misbench::exit_code(misbench::Errc::Internal);
    }
}
