#include "experiments/figure/scene_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "experiments/analysis/cell_images.h"
#include "experiments/figure/auto_crops.h"

namespace misbench::figure {
namespace {

ValueMap mean_of(const std::vector<ValueMap>& maps) {
    ValueMap mean = maps.front();
    for (std::size_t m = 1; m < maps.size(); ++m) {
        for (std::size_t i = 0; i < mean.values.size(); ++i) mean.values[i] += maps[m].values[i];
    }
    for (double& value : mean.values) value /= static_cast<double>(maps.size());
    return mean;
}

// The first seed that all methods have, so that they are shown with the same random numbers.
std::optional<std::int64_t> shown_seed(const std::vector<std::vector<CellRun>>& runs) {
    std::map<std::int64_t, std::size_t> counts;
    std::size_t n_methods = 0;
    for (const std::vector<CellRun>& of_method : runs) {
        n_methods += of_method.empty() ? 0U : 1U;
        for (const CellRun& run : of_method) ++counts[run.seed];
    }
    for (const std::vector<CellRun>& of_method : runs) {
        for (const CellRun& run : of_method) {
            if (counts[run.seed] == n_methods) return run.seed;
        }
    }
    return std::nullopt;
}

// What does not depend on the runs.
void require_automatic_crops_can_be(const AutomaticCrops& crops, const Query& query,
                                    const Metric* metric) {
    if (metric == nullptr) {
        fail_at(crops.place,
                fmt::format("automatic crops need a metric with a value by pixel, which '{}' is "
                            "not; give another as 'metric', or the crops",
                            query.comparison.metric));
    }
    const auto n_methods = std::ranges::count_if(
        query.methods, [](const std::string& method) { return method != kReference; });
    if (n_methods < 2) fail_at(crops.place, "automatic crops need two methods to compare");
}

void require_fit(const SceneViews& scene, const Window& window, const Place& place) {
    if (window.x + window.width <= scene.width && window.y + window.height <= scene.height) {
        return;
    }
    fail_at(place, fmt::format("a crop does not fit into the image of scene '{}', {} x {}",
                               scene.scene, scene.width, scene.height));
}

std::vector<Window> crops_of(const SceneViews& scene, const Crops& crops) {
    if (const auto* given = std::get_if<std::vector<Placed<Window>>>(&crops)) {
        std::vector<Window> windows;
        for (const auto& [window, place] : *given) {
            require_fit(scene, window, place);
            windows.push_back(window);
        }
        return windows;
    }
    const auto& automatic = std::get<AutomaticCrops>(crops);
    require_fit(scene, {0, 0, automatic.width, automatic.height}, automatic.place);
    // Where the last method, the paper's own, differs from what it is compared with.
    const View* last = nullptr;
    const View* against = nullptr;
    for (const View& view : scene.views) {
        if (!view.mean_map) continue;
        if (last != nullptr && (against == nullptr || last->is_baseline())) against = last;
        last = &view;
    }
    if (against == nullptr) {
        fail_at(automatic.place,
                fmt::format("automatic crops need runs of two methods and the reference, which "
                            "scene '{}' does not have yet",
                            scene.scene));
    }
    return auto_crops(*against->mean_map, *last->mean_map, automatic.width, automatic.height,
                      automatic.count);
}

}  // namespace

SceneViews look_at(const Store& store, const Query& query, const SceneEntry& entry,
                   const std::optional<Crops>& crops, const PixelQuestion& question) {
    if (const auto* automatic = crops ? std::get_if<AutomaticCrops>(&*crops) : nullptr) {
        require_automatic_crops_can_be(*automatic, query, question.metric);
    }
    const std::string& name = entry.name.value;
    SceneViews scene{.scene = name};
    scene.exposure = entry.exposure.value_or(
        std::ranges::find(query.plan.scenes, name, &PlannedScene::name)->exposure);
    const Task& task = std::ranges::find(query.plan.cells, name, &Cell::scene)->task;
    scene.width = task.width;
    scene.height = task.height;
    const auto reference = reference_images(store, query.plan, name);
    const bool with_maps = reference && question.metric != nullptr && (question.with_maps || crops);
    std::vector<std::vector<CellRun>> runs;
    for (const std::string& method : query.methods) {
        runs.push_back(finished_runs(store, query.plan, name, method, question.budget));
    }
    const std::optional<std::int64_t> seed = shown_seed(runs);
    for (std::size_t m = 0; m < runs.size(); ++m) {
        View view{.method = query.methods[m],
                  .cell = query.comparison.find(name, query.methods[m], question.budget)};
        if (view.method == kReference && reference) view.image = reference->mean;
        for (const CellRun& run : runs[m]) {
            const Image image = store.run_image(run.run);
            if (run.seed == seed || (!seed && !view.image)) view.image = image;
            if (!with_maps) continue;
            view.maps.push_back(
                {image.width, image.height,
                 measure_map(*question.metric, image, {reference->a, reference->b})});
            view.seeds.push_back(run.seed);
        }
        if (!view.maps.empty()) view.mean_map = mean_of(view.maps);
        scene.views.push_back(std::move(view));
    }
    if (crops) {
        scene.crops = crops_of(scene, *crops);
        scene.crops_are_automatic = std::holds_alternative<AutomaticCrops>(*crops);
    }
    std::vector<Window> parts = scene.crops;
    if (parts.empty()) parts.push_back(scene.whole());
    for (const Window& part : parts) scene.parts.push_back(numbers_of(scene, part));
    return scene;
}

// The seeds' errors in a window, in the shape that statistics of cells have.
PartNumbers numbers_of(const SceneViews& scene, const Window& window) {
    PartNumbers part{.window = window};
    for (const View& view : scene.views) {
        ComparedCell cell;
        cell.method = view.method;
        cell.is_baseline = view.is_baseline();
        for (const ValueMap& map : view.maps) cell.values.push_back(mean_within(map, window));
        cell.seeds = view.seeds;
        cell.mean = estimate_mean(cell.values);
        part.cells.push_back(std::move(cell));
    }
    return part;
}

}  // namespace misbench::figure
