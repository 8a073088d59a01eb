// misbench render: one image, without experiment, store or queue.
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "experiments/cli/output.h"
#include "experiments/cli/verbs.h"
#include "experiments/plan/yaml_reader.h"
#include "experiments/scene_lookup.h"
#include "renderer/base/error.h"
#include "renderer/base/files.h"
#include "renderer/methods/catalogue.h"
#include "renderer/methods/render_loop.h"
#include "results/record.h"

namespace misbench {
namespace {

constexpr int kMaxSide = 16'384;

[[noreturn]] void fail_usage(const std::string& message) {
    throw Error(Errc::InvalidArgument, message);
}

// "640x480".
FrameInfo parse_size(const std::string& text) {
    const auto x = text.find('x');
    const YamlNode sides = parse_yaml(
        x == std::string::npos ? "[]" : "[" + text.substr(0, x) + ", " + text.substr(x + 1) + "]",
        "--size " + text, false);
    if (sides.items.size() != 2) fail_usage("--size " + text + ": must be WIDTHxHEIGHT");
    return {.width = static_cast<int>(read_integer(sides.items[0], "width", 1, kMaxSide)),
            .height = static_cast<int>(read_integer(sides.items[1], "height", 1, kMaxSide))};
}

ParameterMap parse_parameters(const std::vector<std::string>& assignments) {
    ParameterMap parameters;
    for (const std::string& assignment : assignments) {
        const auto equals = assignment.find('=');
        const std::string source = "--set " + assignment;
        if (equals == std::string::npos) fail_usage(source + ": must be KEY=VALUE");
        const std::string key = assignment.substr(0, equals);
        const YamlNode value = parse_yaml(assignment.substr(equals + 1), source, false);
        parameters[key] = read_parameter(value, key);
    }
    return parameters;
}

Budget parse_budget(const RenderOptions& options) {
    if (options.samples.has_value() == options.seconds.has_value()) {
        fail_usage("render: give either --spp or --seconds");
    }
    if (options.samples) return SampleBudget{*options.samples};
    return TimeBudget{*options.seconds,
                      options.clock == "cpu" ? BudgetClock::Cpu : BudgetClock::Wall};
}

void write_image(const RenderOptions& options, const Image& image, const Task& task) {
    const std::filesystem::path output = options.output;
    if (output.extension() == ".exr") {
        write_exr(output, image, {{"misbench.task", task_to_json(task).dump()}});
    } else {
        write_file_durably(output, encode_png(image, options.exposure));
    }
}

// The record as a worker would write it, without what only a worker knows.
std::string record_of(const Task& task, const RenderResult& result) {
    nlohmann::json json = record_to_json({.run = task_id(task),
                                          .task = task,
                                          .statistics = result.statistics,
                                          .valid = result.valid,
                                          .description = result.description,
                                          .worker = {},
                                          .epoch = 0,
                                          .finished_at = {},
                                          .provenance = {},
                                          .image_sha256 = {}});
    for (const char* key : {"worker", "epoch", "finished_at", "provenance", "image_sha256"}) {
        json.erase(key);
    }
    return json.dump(2) + "\n";
}

void print_summary(const RenderOptions& options, const Budget& budget, const RenderResult& result) {
    const RenderStatistics& s = result.statistics;
    print_note(fmt::format(
        "rendered {}: {} spp{} in {:.3g} s wall, {:.3g} s cpu, {} thread{}, "
        "{:.3g} Mrays/s; load {:.3g} s, build {:.3g} s",
        options.output, s.passes,
        has_few_passes(budget, s.passes) ? " (so few that the time limit biases it)" : "",
        s.wall_seconds, s.cpu_seconds, s.threads, s.threads == 1 ? "" : "s",
        1e-6 * static_cast<double>(s.rays) / std::max(s.wall_seconds, 1e-9), s.load_seconds,
        s.build_seconds));
}

std::string why_invalid(const RenderStatistics& s) {
    if (s.passes == 0) return "no pass was completed within the budget";
    std::string why = fmt::format("{} non-finite and {} negative samples", s.nonfinite_samples,
                                  s.negative_samples);
    if (s.first_bad_sample) {
        why += fmt::format(", the first in pixel {},{} of pass {}", s.first_bad_sample->x,
                           s.first_bad_sample->y, s.first_bad_sample->pass);
    }
    return why;
}

}  // namespace

int render_verb(const RenderOptions& options) {
    const std::string extension = std::filesystem::path(options.output).extension();
    if (extension != ".exr" && extension != ".png") {
        fail_usage("write '" + options.output + "': unknown extension; known: .exr .png");
    }
    FrameInfo size;
    if (!options.size.empty()) size = parse_size(options.size);
    const MethodInfo& method = find_method(options.method);
    Task task{.scene_hash = {},
              .width = size.width,
              .height = size.height,
              .method = options.method,
              .method_version = method.version,
              .parameters = method.effective(parse_parameters(options.parameters)),
              .budget = parse_budget(options),
              .seed = options.seed,
              .scene = {},
              .scene_file = {}};
    const SceneListing scene =
        find_scene(options.scene, std::filesystem::current_path(), scene_folder(options.scenes));
    task.scene = scene.name;
    task.scene_file = scene.file.string();
    task.scene_hash = scene_content_hash(scene.file);

    const LoadedScene loaded = load_scene(scene.file, options.threads);
    if (options.size.empty()) {
        const FilmDefaults& film = loaded.scene->film();
        task.width = film.width > 0 ? film.width : 640;
        task.height = film.height > 0 ? film.height : 480;
    }
    RenderResult result = render(*loaded.scene, {.method = task.method,
                                                 .parameters = task.parameters,
                                                 .width = task.width,
                                                 .height = task.height,
                                                 .budget = task.budget,
                                                 .seed = task.seed,
                                                 .threads = options.threads});
    result.statistics.load_seconds = loaded.load_seconds;
    result.statistics.build_seconds = loaded.build_seconds;
    write_image(options, result.image, task);
    print_summary(options, task.budget, result);
    if (options.json) print_result(record_of(task, result));
    if (result.valid) return 0;
    print_error("the image is invalid: " + why_invalid(result.statistics));
    return kExitSomeFailed;
}

}  // namespace misbench
