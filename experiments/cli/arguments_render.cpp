// misbench: the syntax of the verbs that render, and of those that show what there is.
#include <algorithm>
#include <memory>
#include <thread>

#include "experiments/cli/arguments.h"
#include "experiments/cli/verbs.h"

namespace misbench {
namespace {

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

}  // namespace

void add_render_verbs(CLI::App& app, Chosen& chosen) {
    add_list(app, chosen);
    add_render(app, chosen);
    add_replay(app, chosen);
    add_scene(app, chosen);
    add_lab(app, chosen);
}

}  // namespace misbench
