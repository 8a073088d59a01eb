// misbench render: one image, without experiment, store or queue.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "experiments/cli/estimate.h"
#include "experiments/cli/output.h"
#include "experiments/cli/pyramid.h"
#include "experiments/cli/verbs.h"
#include "renderer/base/error.h"
#include "renderer/base/files.h"
#include "renderer/paths/technique_images.h"
#include "results/record.h"

namespace misbench {
namespace {

[[noreturn]] void fail_usage(const std::string& message) {
    throw Error(Errc::InvalidArgument, message);
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

void write_techniques(const RenderOptions& options, const TechniqueImages& sums,
                      const RenderResult& result) {
    const std::int64_t n_passes = result.statistics.passes;
    if (n_passes != *options.samples) {
        fail_usage(fmt::format("write '{}': method '{}' dropped passes that its techniques had",
                               options.techniques, options.estimate.method));
    }
    const std::vector<TechniqueImage> techniques = sums.means(n_passes);
    if (techniques.empty()) {
        fail_usage("write '" + options.techniques + "': no technique found light in this scene");
    }
    const std::filesystem::path output = options.techniques;
    if (output.extension() == ".exr") {
        write_pyramid_exr(output, result.image, techniques);
    } else {
        write_file_durably(output, pyramid_png(techniques, options.exposure));
    }
    if (!options.json) print_result(pyramid_text(result.image, techniques));
}

// A factor's image has one value for all channels.
void write_factors(const RenderOptions& options, const RenderResult& result) {
    if (result.maps.empty()) {
        fail_usage("write '" + options.factors + "': the method learned no factors");
    }
    std::vector<ImageLayer> layers;
    std::vector<std::vector<std::string>> rows{{"factor", "mean", "least", "largest"}};
    for (const NamedImage& map : result.maps) {
        layers.push_back({map.name, &map.image});
        const std::vector<float>& values = map.image.rgb;
        const auto [least, largest] = std::minmax_element(values.begin(), values.end());
        double sum = 0;
        for (const float value : values) sum += double{value};
        rows.push_back({map.name, fmt::format("{:.4g}", sum / static_cast<double>(values.size())),
                        fmt::format("{:.4g}", *least), fmt::format("{:.4g}", *largest)});
    }
    write_exr_layers(options.factors, layers);
    if (!options.json) print_result(align(rows));
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
    require_extension(options.output, {".exr", ".png"});
    if (!options.techniques.empty()) require_extension(options.techniques, {".exr", ".png"});
    if (!options.factors.empty()) require_extension(options.factors, {".exr"});
    const auto [task, loaded] = load_estimate(options.estimate, parse_budget(options));
    RenderRequest request = request_of(task, options.estimate.threads);
    std::optional<TechniqueImages> techniques;
    if (!options.techniques.empty()) {
        request.observer = &techniques.emplace(task.width, task.height);
    }
    RenderResult result = render(*loaded.scene, request);
    result.statistics.load_seconds = loaded.load_seconds;
    result.statistics.build_seconds = loaded.build_seconds;
    write_image(options, result.image, task);
    if (techniques) write_techniques(options, *techniques, result);
    if (!options.factors.empty()) write_factors(options, result);
    print_summary(options, task.budget, result);
    if (options.json) print_result(record_of(task, result));
    if (result.valid) return 0;
    print_error("the image is invalid: " + why_invalid(result.statistics));
    return kExitSomeFailed;
}

}  // namespace misbench
