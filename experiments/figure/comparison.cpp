// Scenes × methods as images: what is shown of the runs, and the numbers below.
#include <fmt/format.h>

#include <algorithm>
#include <set>

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

struct SceneViews {
    std::string scene;
    double exposure = 0;
    std::vector<View> views;  // as the methods
    std::vector<Window> crops;
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
          query_(ask(store, panel, true, true)) {
        for (const Placed<std::string>& name : comparison_.full) find_view(name);
        if (comparison_.maps) {
            map_metric_ = &checked_metric(comparison_.maps->metric);
        } else {
            map_metric_ = &find_metric(query_.comparison.metric);
        }
    }

    Grid make() {
        std::vector<SceneViews> scenes;
        for (const SceneEntry& entry : query_.scenes) scenes.push_back(look_at(entry));
        if (comparison_.maps) scale_ = scale_for(scenes);
        Grid grid{.title = panel_.title, .columns = {}, .blocks = {}, .bar = {}};
        for (const std::string& method : query_.methods) {
            grid.columns.push_back(panel_.title_of(method));
        }
        for (const SceneViews& scene : scenes) grid.blocks.push_back(block_of(scene));
        if (scale_) {
            grid.bar = ColourBar{*scale_, short_name_of_metric(std::string(map_metric_->id)) +
                                              " of a pixel, mean over seeds"};
        }
        return grid;
    }

 private:
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
        const Budget& budget = query_.budgets.front();
        SceneViews scene{.scene = name, .exposure = 0, .views = {}, .crops = {}};
        scene.exposure = entry.exposure.value_or(
            std::ranges::find(query_.plan.scenes, name, &PlannedScene::name)->exposure);
        const auto reference = reference_images(store_, query_.plan, name);
        std::vector<std::vector<CellRun>> runs;
        for (const std::string& method : query_.methods) {
            runs.push_back(finished_runs(store_, query_.plan, name, method, budget));
        }
        const std::optional<std::int64_t> seed = shown_seed(runs);
        for (std::size_t m = 0; m < runs.size(); ++m) {
            View view{.method = query_.methods[m],
                      .image = {},
                      .maps = {},
                      .seeds = {},
                      .mean_map = {},
                      .cell = query_.comparison.find(name, query_.methods[m], budget)};
            if (view.method == kReference && reference) view.image = reference->mean;
            for (const CellRun& run : runs[m]) add_run(view, run, reference, seed);
            if (!view.maps.empty()) view.mean_map = mean_of(view.maps);
            scene.views.push_back(std::move(view));
        }
        if (const auto& crops = entry.crops ? entry.crops : comparison_.crops) {
            scene.crops = crops_of(scene, *crops);
        }
        return scene;
    }

    void add_run(View& view, const CellRun& run, const std::optional<ReferenceImages>& reference,
                 const std::optional<std::int64_t>& shown) const {
        const Image image = store_.run_image(run.run);
        if (run.seed == shown || (!shown && !view.image)) view.image = image;
        if (!reference || map_metric_->map == nullptr) return;
        view.maps.push_back({image.width, image.height,
                             measure_map(*map_metric_, image, {reference->a, reference->b})});
        view.seeds.push_back(run.seed);
    }

    std::vector<Window> crops_of(const SceneViews& scene, const Crops& crops) const {
        const View* any = nullptr;
        std::vector<const View*> with_maps;
        for (const View& view : scene.views) {
            if (view.image) any = &view;
            if (view.mean_map) with_maps.push_back(&view);
        }
        if (any == nullptr) return {};
        const auto fits = [any](const Window& w) {
            return w.x + w.width <= any->image->width && w.y + w.height <= any->image->height;
        };
        const auto require_fit = [&](const Window& window, const Place& place) {
            if (fits(window)) return;
            fail_at(place, fmt::format("a crop does not fit into the image of scene '{}', {} x {}",
                                       scene.scene, any->image->width, any->image->height));
        };
        if (const auto* given = std::get_if<std::vector<Placed<Window>>>(&crops)) {
            std::vector<Window> windows;
            for (const auto& [window, place] : *given) {
                require_fit(window, place);
                windows.push_back(window);
            }
            return windows;
        }
        const auto& automatic = std::get<AutomaticCrops>(crops);
        require_fit({0, 0, automatic.width, automatic.height}, panel_.place);
        if (with_maps.size() < 2) return {};
        // Where the last method, the paper's own, differs from what it is compared with.
        const View* last = with_maps.back();
        const auto is_baseline = [](const View* v) { return v->cell && v->cell->is_baseline; };
        const auto baseline = std::find_if(with_maps.begin(), with_maps.end() - 1, is_baseline);
        const View* against = baseline == with_maps.end() - 1 ? with_maps.front() : *baseline;
        return auto_crops(*against->mean_map, *last->mean_map, automatic.width, automatic.height,
                          automatic.count);
    }

    std::optional<ColourScale> scale_for(const std::vector<SceneViews>& scenes) const {
        const ErrorMaps& wanted = *comparison_.maps;
        if (wanted.range) {
            return ColourScale{(*wanted.range)[0], (*wanted.range)[1], wanted.logarithmic};
        }
        std::vector<const ValueMap*> maps;
        for (const SceneViews& scene : scenes) {
            for (const View& view : scene.views) {
                if (view.mean_map) maps.push_back(&*view.mean_map);
            }
        }
        return scale_of(maps, wanted.logarithmic);
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

    // The seeds' errors in a window, in the shape that statistics of cells have.
    std::vector<ComparedCell> within(const SceneViews& scene, const Window& window) const {
        std::vector<ComparedCell> cells;
        for (const View& view : scene.views) {
            ComparedCell cell;
            cell.method = view.method;
            cell.is_baseline = view.cell != nullptr && view.cell->is_baseline;
            for (const ValueMap& map : view.maps) cell.values.push_back(mean_within(map, window));
            cell.seeds = view.seeds;
            cell.mean = estimate_mean(cell.values);
            cells.push_back(std::move(cell));
        }
        return cells;
    }

    // "0.0123 (×0.54)" for each method.
    std::vector<GridText> insets(const std::vector<ComparedCell>& cells) const {
        const auto baseline = std::ranges::find(cells, true, &ComparedCell::is_baseline);
        const std::optional<std::size_t> best = clear_best(cells, map_metric_->better);
        std::vector<GridText> texts;
        for (std::size_t i = 0; i < cells.size(); ++i) {
            GridText text;
            if (cells[i].mean) {
                text.text = format_mean(plain(cells[i].mean->value));
                if (baseline != cells.end() && !cells[i].is_baseline) {
                    if (const auto ratio = log_ratio(cells[i], *baseline)) {
                        const double value = shown_ratio(to_ratio(*ratio)).value;
                        text.text += " (" + format_ratio(plain(value)) + ")";
                    }
                }
            }
            text.bold = best == i;
            texts.push_back(std::move(text));
        }
        return texts;
    }

    // A row of images, and one of their error maps below if there shall be.
    void add_rows(SceneBlock& block, const SceneViews& scene, const std::optional<Window>& crop,
                  std::optional<Colour> frame, bool with_images) const {
        const View* any = nullptr;
        for (const View& view : scene.views) any = view.image ? &view : any;
        if (any == nullptr) return;
        const Window window = crop.value_or(Window{0, 0, any->image->width, any->image->height});
        GridRow images{.aspect = static_cast<double>(window.width) / window.height, .cells = {}};
        GridRow maps = images;
        const std::vector<GridText> texts = insets(within(scene, window));
        for (std::size_t i = 0; i < scene.views.size(); ++i) {
            const View& view = scene.views[i];
            const std::string name = panel_.title_of(view.method) + ", " + scene.scene;
            GridCell image{.raster = {}, .description = name, .inset = {}, .frame = frame};
            if (view.image) image.raster = cut(to_raster(*view.image, scene.exposure), window);
            GridCell map{
                .raster = {}, .description = "error of " + name, .inset = texts[i], .frame = frame};
            if (view.mean_map && scale_)
                map.raster = cut(to_raster(*view.mean_map, *scale_), window);
            // The reference has no error: its field tells the crop instead.
            if (view.method == kReference)
                map = {.raster = blank(window), .description = "", .inset = {}, .frame = {}};
            if (!comparison_.maps && crop) image.inset = texts[i];
            images.cells.push_back(std::move(image));
            maps.cells.push_back(std::move(map));
        }
        if (with_images) block.rows.push_back(std::move(images));
        if (comparison_.maps) block.rows.push_back(std::move(maps));
    }

    static Raster blank(const Window& window) {
        return {window.width, window.height,
                std::vector<std::uint8_t>(3 * static_cast<std::size_t>(window.width) *
                                              static_cast<std::size_t>(window.height),
                                          255)};
    }

    SceneBlock block_of(const SceneViews& scene) const {
        SceneBlock block{.title = panel_.title_of(scene.scene)};
        block.note = short_name_of_metric(query_.comparison.metric) +
                     (comparison_.gain ? ", gain over " : ", ratio to ") +
                     panel_.title_of(query_.plan.baseline);
        for (std::size_t i = 0; i < scene.crops.size(); ++i) {
            block.marks.push_back({scene.crops[i], series_colour(i)});
            add_rows(block, scene, scene.crops[i], series_colour(i), true);
        }
        if (scene.crops.empty()) {
            add_rows(block, scene, {}, {}, true);
        } else if (comparison_.maps && comparison_.maps->whole) {
            add_rows(block, scene, {}, {}, false);
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
        std::vector<ComparedCell> cells;
        for (const View& view : scene.views) {
            cells.push_back(view.cell == nullptr ? ComparedCell{} : *view.cell);
        }
        const auto best = clear_best(cells, query_.comparison.better);
        for (std::size_t i = 0; i < cells.size(); ++i) {
            std::vector<GridText> lines;
            if (cells[i].mean) {
                lines.push_back({format_mean(plain(cells[i].mean->value)), best == i});
                if (cells[i].is_baseline) lines.push_back({"baseline"});
                if (cells[i].ratio) {
                    lines.push_back({format_ratio(shown_ratio(*cells[i].ratio)), best == i});
                }
            }
            block.captions.push_back(std::move(lines));
        }
    }

    const Store& store_;
    const Panel& panel_;
    const ComparisonPanel& comparison_;
    Query query_;
    const Metric* map_metric_ = nullptr;
    std::optional<ColourScale> scale_;
};

}  // namespace

double draw_comparison(Drawing& drawing, const Style& style, const Store& store, const Panel& panel,
                       double top) {
    return draw_grid(drawing, style, ComparisonMaker(store, panel).make(), top);
}

}  // namespace misbench::figure
