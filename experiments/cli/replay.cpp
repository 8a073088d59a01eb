// misbench replay: one pixel of one pass again, with the whole story of its samples.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "experiments/cli/estimate.h"
#include "experiments/cli/output.h"
#include "experiments/cli/path_story.h"
#include "experiments/cli/run_lookup.h"
#include "experiments/cli/verbs.h"
#include "experiments/scene_lookup.h"
#include "renderer/base/build_info.h"
#include "renderer/base/error.h"
#include "renderer/methods/catalogue.h"
#include "results/store.h"

namespace misbench {
namespace {

[[noreturn]] void fail_usage(const std::string& message) {
    throw Error(Errc::InvalidArgument, message);
}

// What is rendered again, and what of it is shown.
struct Replay {
    std::string run;  // "" without one
    Estimate estimate;
    std::int64_t n_passes = 0;  // of the run
    Pixel pixel;
    std::int64_t pass = 0;
};

Pixel parse_pixel(const std::string& text, const Task& task) {
    const std::vector<YamlNode> xy = parse_pair("--pixel", text, ',', "x,y");
    return {.x = static_cast<int>(read_integer(xy[0], "x", 0, task.width - 1)),
            .y = static_cast<int>(read_integer(xy[1], "y", 0, task.height - 1))};
}

// Only the very same scene and method give the very same samples.
void require_same(const Task& task) {
    const int version = find_method(task.method).version;
    if (version != task.method_version) {
        fail_usage(fmt::format("replay method '{}': the run is of its version {}; known: {}",
                               task.method, task.method_version, version));
    }
    const std::string hash = scene_content_hash(task.scene_file);
    if (hash != task.scene_hash) {
        fail_usage(fmt::format(
            "replay scene '{}': it changed since the run; its hash is {}, the run's is {}",
            task.scene_file, hash, task.scene_hash));
    }
}

Replay replay_of_run(const ReplayOptions& options) {
    const Store store(options.store, Store::Access::ReadOnly);
    const Record record = store.run(find_run(store, options.run)).value();
    const std::optional<SamplePlace>& bad = record.statistics.first_bad_sample;
    Replay replay{.run = record.run,
                  .estimate = {.task = record.task, .loaded = {}},
                  .n_passes = record.statistics.passes + record.statistics.training_passes,
                  .pixel = {},
                  .pass = options.sample.value_or(0)};
    Task& task = replay.estimate.task;
    if (!options.pixel.empty()) {
        replay.pixel = parse_pixel(options.pixel, task);
    } else if (bad) {
        replay.pixel = {.x = bad->x, .y = bad->y};
        replay.pass = options.sample.value_or(bad->pass);
    } else {
        fail_usage("replay: give --pixel, run " + record.run + " has no bad sample");
    }
    if (replay.pass >= replay.n_passes) {
        fail_usage(fmt::format("--sample {}: run {} has {} samples a pixel, counted from 0",
                               replay.pass, record.run, replay.n_passes));
    }
    if (!options.estimate.scene.empty()) {
        task.scene_file = find_scene(options.estimate.scene, std::filesystem::current_path(),
                                     scene_folder(options.estimate.scenes))
                              .file.string();
    }
    require_same(task);
    if (record.provenance.build_id != build_id()) {
        print_note(fmt::format("run {} is of build {}, this is {}: samples may differ", record.run,
                               record.provenance.build_id, build_id()));
    }
    replay.estimate.loaded = load_scene(task.scene_file, options.estimate.threads);
    return replay;
}

Replay replay_of_estimate(const ReplayOptions& options) {
    if (options.estimate.scene.empty() || options.estimate.method.empty()) {
        fail_usage("replay: give a run and its --store, or --scene and --method");
    }
    if (options.pixel.empty()) fail_usage("replay: give --pixel");
    const std::int64_t pass = options.sample.value_or(0);
    Replay replay{.run = {},
                  .estimate = load_estimate(options.estimate, SampleBudget{pass + 1}),
                  .n_passes = pass + 1,
                  .pixel = {},
                  .pass = pass};
    replay.pixel = parse_pixel(options.pixel, replay.estimate.task);
    return replay;
}

std::string heading(const Replay& replay, std::size_t n_samples) {
    const Task& task = replay.estimate.task;
    std::string text =
        replay.run.empty() ? "" : fmt::format("run {}, {} spp\n", replay.run, replay.n_passes);
    text += fmt::format("scene {}, {}x{}, method {}, seed {}\n", task.scene, task.width,
                        task.height, task.method, task.seed);
    for (const auto& [key, value] : task.parameters) {
        text += fmt::format("{}{}={}", text.back() == '\n' ? "" : " ", key, to_string(value));
    }
    text += fmt::format("\npixel {},{} of pass {}: {} samples\n", replay.pixel.x, replay.pixel.y,
                        replay.pass, n_samples);
    return text;
}

}  // namespace

int replay_verb(const ReplayOptions& options) {
    const Replay replay =
        options.run.empty() ? replay_of_estimate(options) : replay_of_run(options);
    const auto& [task, loaded] = replay.estimate;
    PixelTrace trace(replay.pixel);
    RenderRequest request = request_of(task, options.estimate.threads);
    request.only_pass = replay.pass;
    request.observer = &trace;
    const RenderResult result = render(*loaded.scene, request);

    const auto [x, y] = replay.pixel;
    const float* rgb = &result.image.rgb[3 * static_cast<std::size_t>(y * task.width + x)];
    const RgbSum in_pass = {double{rgb[0]}, double{rgb[1]}, double{rgb[2]}};
    const std::vector<KeptSample> samples = by_weighted_value(trace.samples());
    const RgbSum sum = weighted_sum(samples);
    if (options.json) {
        nlohmann::ordered_json json;
        if (!replay.run.empty()) json["run"] = replay.run;
        json["task"] = task_to_json(task);
        json["pixel"] = {x, y};
        json["pass"] = replay.pass;
        json["samples"] = story_to_json(samples, *loaded.scene);
        json["sum"] = rgb_to_json(sum);
        json["pixel_value"] = rgb_to_json(in_pass);
        print_result(json.dump(2) + "\n");
        return 0;
    }
    print_result(heading(replay, samples.size()) + story_to_text(samples, *loaded.scene) + "\n" +
                 align({{"sum of weighted values", rgb_to_text(sum)},
                        {"pixel of the pass", rgb_to_text(in_pass)}}));
    return 0;
}

}  // namespace misbench
