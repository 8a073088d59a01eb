// misbench scene: what a scene requires (info), and what in it would spoil a benchmark (check).
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <nlohmann/json.hpp>

#include "experiments/cli/output.h"
#include "experiments/cli/scene_facts.h"
#include "experiments/cli/verbs.h"
#include "experiments/scene_lookup.h"
#include "renderer/base/error.h"
#include "renderer/methods/method.h"
#include "renderer/methods/render_loop.h"

namespace misbench {
namespace {

using Json = nlohmann::ordered_json;
using Rows = std::vector<std::vector<std::string>>;

constexpr int kCheckSide = 128;        // pixels, of the longer side of the check's image
constexpr double kCheckSeconds = 1;    // wall
constexpr std::size_t kMaxLines = 10;  // of one kind of warning, in text

// One scene of the folder's table: its row and JSON, or how it was refused.
struct TableEntry {
    std::vector<std::string> row;
    Json json;
    bool is_refused = false;
};

TableEntry table_entry(const SceneListing& listing, int threads) {
    try {
        const LoadedScene loaded = load_scene(listing.file, threads);
        const SceneFacts facts = inspect(loaded);
        return {.row = {listing.name, std::to_string(facts.n_triangles), light_types(facts),
                        material_types(facts), std::to_string(facts.textures.size()),
                        feature_list(*loaded.scene), fmt::format("{:.3g}", loaded.load_seconds),
                        fmt::format("{:.3g}", loaded.build_seconds)},
                .json = facts_to_json(listing, loaded, facts)};
    } catch (const Error& e) {
        return {.row = {listing.name, std::string("refused: ") + e.what()},
                .json = {{"name", listing.name},
                         {"file", listing.file.string()},
                         {"refused", e.what()}},
                .is_refused = true};
    }
}

// Refusals are long: they follow the table's columns, one line each.
int print_table(const SceneOptions& options) {
    Rows rows = {
        {"scene", "triangles", "lights", "materials", "textures", "features", "load s", "build s"}};
    std::string refusals;
    Json json = Json::array();
    for (const SceneListing& listing : list_scenes(scene_folder(options.scenes))) {
        TableEntry entry = table_entry(listing, options.threads);
        json.push_back(std::move(entry.json));
        if (entry.is_refused) {
            refusals += entry.row[0] + "  " + entry.row[1] + "\n";
        } else {
            rows.push_back(std::move(entry.row));
        }
    }
    print_result(options.json ? json.dump(2) + "\n" : align(rows) + refusals);
    return refusals.empty() ? 0 : kExitUsage;
}

SceneListing find(const SceneOptions& options) {
    return find_scene(options.scene, std::filesystem::current_path(), scene_folder(options.scenes));
}

// In the file's proportions, or 4:3.
FrameInfo check_size(const FilmDefaults& film) {
    const int width = film.width > 0 ? film.width : 4;
    const int height = film.height > 0 ? film.height : 3;
    const int longer = std::max(width, height);
    return {.width = std::max(1, kCheckSide * width / longer),
            .height = std::max(1, kCheckSide * height / longer)};
}

RenderResult render_check(const Scene& scene, int threads) {
    const FrameInfo size = check_size(scene.film());
    RenderRequest request{.method = "path",
                          .parameters = {},
                          .width = size.width,
                          .height = size.height,
                          .budget = TimeBudget{kCheckSeconds, BudgetClock::Wall},
                          .seed = 1,
                          .threads = threads};
    RenderResult result = render(scene, request);
    if (result.statistics.passes > 0) return result;
    request.budget = SampleBudget{1};
    return render(scene, request);
}

std::vector<SceneWarning> check_render(const Scene& scene, const RenderResult& result) {
    std::vector<SceneWarning> warnings;
    const RenderStatistics& s = result.statistics;
    if (!result.valid && s.first_bad_sample) {
        warnings.push_back(
            {SceneWarning::Kind::BadSamples, "",
             fmt::format("method path gives {} non-finite and {} negative samples, "
                         "the first in pixel {},{} of {}x{} in pass {}",
                         s.nonfinite_samples, s.negative_samples, s.first_bad_sample->x,
                         s.first_bad_sample->y, result.image.width, result.image.height,
                         s.first_bad_sample->pass)});
    }
    const bool is_black = std::all_of(result.image.rgb.begin(), result.image.rgb.end(),
                                      [](float value) { return value == 0; });
    if (is_black && !scene.lights().empty()) {
        warnings.push_back(
            {SceneWarning::Kind::BlackImage, "",
             fmt::format("the image stays black after {} samples a pixel", s.passes)});
    }
    return warnings;
}

Json warnings_to_json(const std::vector<SceneWarning>& warnings) {
    Json json = Json::array();
    for (const SceneWarning& warning : warnings) {
        json.push_back({{"kind", name(warning.kind)},
                        {"object", warning.object},
                        {"message", warning.message}});
    }
    return json;
}

std::string warnings_to_text(const std::vector<SceneWarning>& warnings) {
    std::string text;
    std::map<SceneWarning::Kind, std::size_t> n_of_kind;
    for (const SceneWarning& warning : warnings) {
        if (++n_of_kind[warning.kind] > kMaxLines) continue;
        text += fmt::format("warning {}: {}{}{}\n", name(warning.kind), warning.object,
                            warning.object.empty() ? "" : ": ", warning.message);
    }
    for (const auto& [kind, n] : n_of_kind) {
        if (n <= kMaxLines) continue;
        text += fmt::format("warning {}: {} more, see --json\n", name(kind), n - kMaxLines);
    }
    return text.empty() ? "no warnings\n" : text;
}

}  // namespace

int scene_info_verb(const SceneOptions& options) {
    if (options.scene.empty()) return print_table(options);
    const SceneListing listing = find(options);
    const LoadedScene loaded = load_scene(listing.file, options.threads);
    const SceneFacts facts = inspect(loaded);
    print_result(options.json ? facts_to_json(listing, loaded, facts).dump(2) + "\n"
                              : facts_to_text(listing, loaded, facts));
    return 0;
}

int scene_check_verb(const SceneOptions& options) {
    const SceneListing listing = find(options);
    const auto start = std::chrono::steady_clock::now();
    SceneDescription description = import_scene(listing.file);
    const std::chrono::duration<double> load_time = std::chrono::steady_clock::now() - start;
    std::vector<SceneWarning> warnings = check_description(description);
    const std::vector<SceneObject> objects = scene_objects(description);
    LoadedScene loaded = build_scene(std::move(description), options.threads);
    loaded.load_seconds = load_time.count();
    const Scene& scene = *loaded.scene;
    const RenderResult result = render_check(scene, options.threads);
    for (const auto& more : {check_scene(scene, objects), check_render(scene, result)}) {
        warnings.insert(warnings.end(), more.begin(), more.end());
    }

    const SceneFacts facts = inspect(loaded);
    const RenderStatistics& s = result.statistics;
    if (options.json) {
        Json json = facts_to_json(listing, loaded, facts);
        json["render"] = {{"width", result.image.width},
                          {"height", result.image.height},
                          {"passes", s.passes},
                          {"wall_seconds", s.wall_seconds},
                          {"cpu_seconds", s.cpu_seconds},
                          {"threads", s.threads},
                          {"rays", s.rays}};
        json["warnings"] = warnings_to_json(warnings);
        print_result(json.dump(2) + "\n");
    } else {
        print_result(
            facts_to_text(listing, loaded, facts) +
            fmt::format("rendered {}x{} by method path: {} spp in {:.3g} s, "
                        "{:.3g} Mrays/s on {} threads\n",
                        result.image.width, result.image.height, s.passes, s.wall_seconds,
                        1e-6 * static_cast<double>(s.rays) / std::max(s.wall_seconds, 1e-9),
                        s.threads) +
            warnings_to_text(warnings));
    }
    return warnings.empty() ? 0 : kExitSomeFailed;
}

}  // namespace misbench
