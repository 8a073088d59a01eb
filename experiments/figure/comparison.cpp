// Scenes × methods as images: what is shown of the runs, and the numbers below.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "experiments/analysis/cell_images.h"
#include "experiments/figure/auto_crops.h"
#include "experiments/figure/clear_best.h"
#include "experiments/figure/colour_map.h"
#include "experiments/figure/grid.h"
#include "experiments/figure/query.h"
#include "experiments/report/numbers.h"
#include "renderer/base/error.h"
#include "results/metrics/metrics.h"

namespace misbench::figure {
namespace {

// The runs of one method in one scene; of the reference its mean.
struct View {
    std::string method;
    std::optional<Image> image;        // of the seed that is shown
    std::vector<ValueMap> maps;        // of the error, one a seed
    std::vector<std::int64_t> seeds;   // of the maps
    std::optional<ValueMap> mean_map;  // over the seeds
    const ComparedCell* cell = nullptr;
};

// The errors in a part of the image.
struct PartNumbers {
    Window window;
    std::vector<ComparedCell> cells;  // as the methods
    std::optional<std::size_t> best;
};

struct SceneViews {
    std::string scene;
    double exposure = 0;
    int width = 0;
    int height = 0;
    std::vector<View> views;  // as the methods
    std::vector<Window> crops;
    std::vector<PartNumbers> parts;   // the crops, or the whole image where there are none
    std::optional<std::size_t> best;  // of the whole image, by the panel's metric

    Window whole() const { return {0, 0, width, height}; }
};

Estimate plain(double value) { return {.value = value, .interval = {}, .why_none = {}}; }

ValueMap mean_of(const std::vector<ValueMap>& maps) {
    ValueMap mean = maps.front();
    for (std::size_t m = 1; m < maps.size(); ++m) {
        for (std::size_t i = 0; i < mean.values.size(); ++i) mean.values[i] += maps[m].values[i];
    }
    for (double& value : mean.values) value /= static_cast<double>(maps.size());
    return mean;
}

class ComparisonMaker {
 public:
    ComparisonMaker(const Store& store, const Panel& panel)
        : store_(store),
          panel_(panel),
          comparison_(std::get<ComparisonPanel>(panel.kind)),
          query_(ask(store, panel, true)),
          budget_(budget_of(query_, panel)),
          map_metric_(choose_map_metric()) {
        for (const Placed<std::string>& name : comparison_.full) find_view(name);
        for (const SceneEntry& entry : query_.scenes) require_automatic_crops_can_be(entry);
    }

    Grid make() {
        std::vector<SceneViews> scenes;
        for (const SceneEntry& entry : query_.scenes) scenes.push_back(look_at(entry));
        find_bests(scenes);
        Grid grid{.title = panel_.title};
        for (const std::string& method : query_.methods) {
            grid.columns.push_back(panel_.title_of(method));
        }
        if (comparison_.maps) {
            scale_ = scale_for(scenes);
            grid.bar = ColourBar{*scale_, name_of_map() + " of a pixel, mean over seeds"};
        }
        bool has_insets = false;
        for (const SceneViews& scene : scenes) {
            grid.blocks.push_back(block_of(scene));
            has_insets |= shows_insets(scene);
        }
        if (has_insets) {
            grid.notes.push_back(fmt::format(
                "Numbers in images: mean {} of the part that is shown, untrimmed, and its {}{}.",
                name_of_map(), comparison_.gain ? "gain over " : "ratio to ",
                panel_.title_of(query_.plan.baseline)));
        }
        return grid;
    }

 private:
    // Null where neither maps nor errors of crops can be.
    const Metric* choose_map_metric() const {
        if (comparison_.maps) return &checked_metric(comparison_.maps->metric);
        const std::string& id = query_.comparison.metric;
        if (std::ranges::find(query_.plan.metrics, id) == query_.plan.metrics.end()) return nullptr;
        const Metric& metric = find_metric(id);
        return metric.map == nullptr ? nullptr : &metric;
    }

    const Metric& checked_metric(const Placed<std::string>& id) const {
        try {
            const Metric& metric = find_metric(id.value);
            if (metric.map == nullptr) {
                fail_at(id.place, "metric '" + id.value + "' has no value by pixel");
            }
            return metric;
        } catch (const ParameterError& e) {
            fail_at(id.place, e.what());
        }
    }

    std::string name_of_map() const {
        const std::string id(map_metric_->id);
        return short_name_of_metric(id.substr(0, id.find(".trim")));
    }

    const std::optional<Crops>& wanted_crops(const SceneEntry& entry) const {
        return entry.crops ? entry.crops : comparison_.crops;
    }

    void require_automatic_crops_can_be(const SceneEntry& entry) const {
        const std::optional<Crops>& crops = wanted_crops(entry);
        const auto* automatic = crops ? std::get_if<AutomaticCrops>(&*crops) : nullptr;
        if (automatic == nullptr) return;
        if (map_metric_ == nullptr) {
            fail_at(automatic->place,
                    fmt::format("automatic crops need a metric with a value by pixel, which '{}' "
                                "is not; give another as 'metric', or the crops",
                                query_.comparison.metric));
        }
        const auto n_methods = std::ranges::count_if(
            query_.methods, [](const std::string& method) { return method != kReference; });
        if (n_methods < 2) {
            fail_at(automatic->place, "automatic crops need two methods to compare");
        }
    }

    // Its index among the methods that are shown.
    std::size_t find_view(const Placed<std::string>& name) const {
        const auto found = std::ranges::find(query_.methods, name.value);
        if (found == query_.methods.end()) {
            fail_at(name.place, fmt::format("'{}' is not among the panel's methods: {}", name.value,
                                            fmt::join(query_.methods, " ")));
        }
        return static_cast<std::size_t>(found - query_.methods.begin());
    }

    // --- what the store has --------------------------------------------------------------------

    // The first seed that all methods have, so that they are shown with the same random numbers.
    std::optional<std::int64_t> shown_seed(const std::vector<std::vector<CellRun>>& runs) const {
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

    SceneViews look_at(const SceneEntry& entry) const {
        const std::string& name = entry.name.value;
        SceneViews scene{.scene = name};
        scene.exposure = entry.exposure.value_or(
            std::ranges::find(query_.plan.scenes, name, &PlannedScene::name)->exposure);
        const Task& task = std::ranges::find(query_.plan.cells, name, &Cell::scene)->task;
        scene.width = task.width;
        scene.height = task.height;
        const auto reference = reference_images(store_, query_.plan, name);
        std::vector<std::vector<CellRun>> runs;
        for (const std::string& method : query_.methods) {
            runs.push_back(finished_runs(store_, query_.plan, name, method, budget_));
        }
        const std::optional<std::int64_t> seed = shown_seed(runs);
        const std::optional<Crops>& crops = wanted_crops(entry);
        const bool with_maps = map_metric_ != nullptr && (comparison_.maps || crops);
        for (std::size_t m = 0; m < runs.size(); ++m) {
            View view{.method = query_.methods[m],
                      .cell = query_.comparison.find(name, query_.methods[m], budget_)};
            if (view.method == kReference && reference) view.image = reference->mean;
            for (const CellRun& run : runs[m]) {
                const Image image = store_.run_image(run.run);
                if (run.seed == seed || (!seed && !view.image)) view.image = image;
                if (!with_maps || !reference) continue;
                view.maps.push_back(
                    {image.width, image.height,
                     measure_map(*map_metric_, image, {reference->a, reference->b})});
                view.seeds.push_back(run.seed);
            }
            if (!view.maps.empty()) view.mean_map = mean_of(view.maps);
            scene.views.push_back(std::move(view));
        }
        if (crops) scene.crops = crops_of(scene, *crops);
        std::vector<Window> parts = scene.crops;
        if (parts.empty()) parts.push_back(scene.whole());
        for (const Window& part : parts) scene.parts.push_back(numbers_of(scene, part));
        return scene;
    }

    static void require_fit(const SceneViews& scene, const Window& window, const Place& place) {
        if (window.x + window.width <= scene.width && window.y + window.height <= scene.height) {
            return;
        }
        fail_at(place, fmt::format("a crop does not fit into the image of scene '{}', {} x {}",
                                   scene.scene, scene.width, scene.height));
    }

    std::vector<Window> crops_of(const SceneViews& scene, const Crops& crops) const {
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
            if (last != nullptr && (against == nullptr || is_baseline(*last))) against = last;
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

    static bool is_baseline(const View& view) {
        return view.cell != nullptr && view.cell->is_baseline;
    }

    ColourScale scale_for(const std::vector<SceneViews>& scenes) const {
        const ErrorMaps& wanted = *comparison_.maps;
        if (wanted.range) {
            return {(*wanted.range)[0], (*wanted.range)[1], wanted.logarithmic};
        }
        std::vector<const ValueMap*> maps;
        for (const SceneViews& scene : scenes) {
            for (const View& view : scene.views) {
                if (view.mean_map) maps.push_back(&*view.mean_map);
            }
        }
        return scale_of(maps, wanted.logarithmic);
    }

    // --- its numbers ---------------------------------------------------------------------------

    // The seeds' errors in a window, in the shape that statistics of cells have.
    static PartNumbers numbers_of(const SceneViews& scene, const Window& window) {
        PartNumbers part{.window = window};
        for (const View& view : scene.views) {
            ComparedCell cell;
            cell.method = view.method;
            cell.is_baseline = is_baseline(view);
            for (const ValueMap& map : view.maps) cell.values.push_back(mean_within(map, window));
            cell.seeds = view.seeds;
            cell.mean = estimate_mean(cell.values);
            part.cells.push_back(std::move(cell));
        }
        return part;
    }

    void find_bests(std::vector<SceneViews>& scenes) const {
        std::vector<std::vector<ComparedCell>> captions;
        std::vector<std::vector<ComparedCell>> insets;
        for (const SceneViews& scene : scenes) {
            std::vector<ComparedCell>& cells = captions.emplace_back();
            for (const View& view : scene.views) {
                cells.push_back(view.cell == nullptr ? ComparedCell{} : *view.cell);
            }
            for (const PartNumbers& part : scene.parts) insets.push_back(part.cells);
        }
        const auto best_captions = clear_bests(captions, query_.comparison.better);
        const auto best_insets =
            clear_bests(insets, map_metric_ == nullptr ? Direction::None : map_metric_->better);
        std::size_t inset = 0;
        for (std::size_t s = 0; s < scenes.size(); ++s) {
            scenes[s].best = best_captions[s];
            for (PartNumbers& part : scenes[s].parts) part.best = best_insets[inset++];
        }
    }

    // --- what is shown of it -------------------------------------------------------------------

    Estimate shown_ratio(const Estimate& ratio) const {
        if (!comparison_.gain) return ratio;
        Estimate gain = ratio;
        gain.value = 1 / ratio.value;
        if (ratio.interval)
            gain.interval = Interval{1 / ratio.interval->high, 1 / ratio.interval->low};
        return gain;
    }

    bool shows_insets(const SceneViews& scene) const {
        return map_metric_ != nullptr && (comparison_.maps || !scene.crops.empty());
    }

    // "0.0123 (×0.54)" for each method.
    std::vector<GridText> insets(const PartNumbers& part) const {
        const auto baseline = std::ranges::find(part.cells, true, &ComparedCell::is_baseline);
        std::vector<GridText> texts;
        for (std::size_t i = 0; i < part.cells.size(); ++i) {
            const ComparedCell& cell = part.cells[i];
            GridText text{.bold = part.best == i};
            if (cell.mean) text.text = format_mean(plain(cell.mean->value));
            if (cell.mean && baseline != part.cells.end() && !cell.is_baseline) {
                if (const auto ratio = log_ratio(cell, *baseline)) {
                    const double value = shown_ratio(to_ratio(*ratio)).value;
                    text.text += " (" + format_ratio(plain(value)) + ")";
                }
            }
            texts.push_back(std::move(text));
        }
        return texts;
    }

    std::string description(const SceneViews& scene, const View& view) const {
        return panel_.title_of(view.method) + ", " + panel_.title_of(scene.scene);
    }

    static GridRow empty_row(const Window& window) {
        return {.aspect = static_cast<double>(window.width) / window.height, .cells = {}};
    }

    GridRow image_row(const SceneViews& scene, const PartNumbers& part,
                      std::optional<Colour> frame) const {
        GridRow row = empty_row(part.window);
        const std::vector<GridText> texts = insets(part);
        for (std::size_t i = 0; i < scene.views.size(); ++i) {
            const View& view = scene.views[i];
            GridCell cell{.description = description(scene, view), .frame = frame};
            if (view.image) cell.raster = cut(to_raster(*view.image, scene.exposure), part.window);
            if (!comparison_.maps && shows_insets(scene)) cell.inset = texts[i];
            row.cells.push_back(std::move(cell));
        }
        return row;
    }

    GridRow map_row(const SceneViews& scene, const PartNumbers& part,
                    std::optional<Colour> frame) const {
        GridRow row = empty_row(part.window);
        const std::vector<GridText> texts = insets(part);
        for (std::size_t i = 0; i < scene.views.size(); ++i) {
            const View& view = scene.views[i];
            GridCell cell{.description = "error of " + description(scene, view),
                          .inset = texts[i],
                          .frame = frame};
            if (view.image) cell.missing = "no reference";
            if (view.mean_map) cell.raster = cut(to_raster(*view.mean_map, *scale_), part.window);
            if (view.method == kReference) cell = {.is_blank = true};  // it has no error
            row.cells.push_back(std::move(cell));
        }
        return row;
    }

    SceneBlock block_of(const SceneViews& scene) const {
        SceneBlock block{.title = panel_.title_of(scene.scene)};
        block.note = short_name_of_metric(query_.comparison.metric) +
                     (comparison_.gain ? ", gain over " : ", ratio to ") +
                     panel_.title_of(query_.plan.baseline);
        for (std::size_t i = 0; i < scene.parts.size(); ++i) {
            std::optional<Colour> colour;
            if (!scene.crops.empty()) {
                colour = series_colour(i);
                block.marks.push_back({scene.crops[i], *colour});
            }
            block.rows.push_back(image_row(scene, scene.parts[i], colour));
            if (comparison_.maps) block.rows.push_back(map_row(scene, scene.parts[i], colour));
        }
        if (!scene.crops.empty() && comparison_.maps && comparison_.maps->whole) {
            block.rows.push_back(map_row(scene, numbers_of(scene, scene.whole()), {}));
        }
        add_full(block, scene);
        add_captions(block, scene);
        return block;
    }

    void add_full(SceneBlock& block, const SceneViews& scene) const {
        std::vector<const View*> shown;
        for (const Placed<std::string>& name : comparison_.full) {
            shown.push_back(&scene.views[find_view(name)]);
        }
        if (shown.empty() && !scene.crops.empty()) shown.push_back(&scene.views.front());
        if (shown.empty() ||
            !std::ranges::all_of(shown, [](const View* v) { return v->image.has_value(); })) {
            return;
        }
        block.full = to_raster(*shown.front()->image, scene.exposure);
        if (shown.size() < 2) return;
        block.full = split(*block.full, to_raster(*shown[1]->image, scene.exposure));
        for (const View* view : shown) block.full_labels.push_back(panel_.title_of(view->method));
    }

    void add_captions(SceneBlock& block, const SceneViews& scene) const {
        for (std::size_t i = 0; i < scene.views.size(); ++i) {
            std::vector<GridText> lines;
            if (const ComparedCell* cell = scene.views[i].cell) {
                const bool is_best = scene.best == i;
                if (cell->mean) {
                    lines.push_back({format_mean(plain(cell->mean->value)), is_best});
                }
                if (cell->is_baseline) lines.push_back({"baseline"});
                if (cell->ratio)
                    lines.push_back({format_ratio(shown_ratio(*cell->ratio)), is_best});
                if (!cell->is_complete()) lines.push_back({status_of(*cell)});
            }
            block.captions.push_back(std::move(lines));
        }
    }

    const Store& store_;
    const Panel& panel_;
    const ComparisonPanel& comparison_;
    Query query_;
    Budget budget_;
    const Metric* map_metric_;
    std::optional<ColourScale> scale_;
};

}  // namespace

double draw_comparison(Drawing& drawing, const Style& style, const Store& store, const Panel& panel,
                       double top) {
    return draw_grid(drawing, style, ComparisonMaker(store, panel).make(), top);
}

}  // namespace misbench::figure
