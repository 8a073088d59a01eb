// Scenes × methods as images: what is shown of the runs, and the numbers below.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "experiments/figure/clear_best.h"
#include "experiments/figure/colour_map.h"
#include "experiments/figure/grid.h"
#include "experiments/figure/query.h"
#include "experiments/figure/scene_views.h"
#include "experiments/report/numbers.h"
#include "renderer/base/error.h"
#include "results/metrics/metrics.h"

namespace misbench::figure {
namespace {

Estimate plain(double value) { return {.value = value, .interval = {}, .why_none = {}}; }

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
    }

    Grid make() {
        std::vector<SceneViews> scenes;
        for (const SceneEntry& entry : query_.scenes) {
            scenes.push_back(look_at(store_, query_, entry,
                                     entry.crops ? entry.crops : comparison_.crops,
                                     {budget_, map_metric_, comparison_.maps.has_value()}));
        }
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
        bool has_room = true;  // to say beside a whole image what the captions are
        for (const SceneViews& scene : scenes) {
            grid.blocks.push_back(block_of(scene));
            has_insets |= shows_insets(scene);
            has_room &= grid.blocks.back().full.has_value();
        }
        if (!has_room) grid.notes.push_back("Numbers below: " + grid.blocks[0].note + ".");
        if (has_insets) {
            grid.notes.push_back(
                fmt::format("Numbers in images: mean {} of what is shown, untrimmed, and its {}.",
                            name_of_map(), ratio_words()));
        }
        if (std::ranges::any_of(scenes, &SceneViews::crops_are_automatic)) {
            grid.notes.push_back("Crops are chosen where the errors of methods differ most.");
        }
        if (has_bold(scenes)) {
            grid.notes.push_back(
                "Bold: best, and different from each other method at a false discovery rate of 5 "
                "%.");
        }
        for (const NoInterval reason : reasons_for_no_interval()) {
            grid.notes.push_back("No interval: " + to_string(reason) + ".");
        }
        return grid;
    }

 private:
    // Of the ratios below images.
    std::set<NoInterval> reasons_for_no_interval() const {
        std::set<NoInterval> reasons;
        for (const SceneEntry& scene : query_.scenes) {
            for (const std::string& method : query_.methods) {
                const ComparedCell* cell =
                    query_.comparison.find(scene.name.value, method, budget_);
                if (cell == nullptr || !cell->ratio || !cell->ratio->why_none) continue;
                reasons.insert(*cell->ratio->why_none);
            }
        }
        return reasons;
    }

    static bool has_bold(const std::vector<SceneViews>& scenes) {
        return std::ranges::any_of(scenes, [](const SceneViews& scene) {
            return scene.best || std::ranges::any_of(scene.parts, [](const PartNumbers& part) {
                       return part.best.has_value();
                   });
        });
    }

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

    std::string ratio_words() const {
        return (comparison_.gain ? "gain over " : "ratio to ") +
               panel_.title_of(query_.plan.baseline);
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

    void find_bests(std::vector<SceneViews>& scenes) const {
        std::vector<std::vector<ComparedCell>> captions;
        std::vector<std::vector<ComparedCell>> insets;
        for (const SceneViews& scene : scenes) {
            std::vector<ComparedCell>& cells = captions.emplace_back();
            for (const View& view : scene.views) {
                cells.push_back(view.cell == nullptr ? ComparedCell{} : *view.cell);
            }
            // Where crops are chosen for their difference, it is no finding that there is one.
            if (scene.crops_are_automatic) continue;
            for (const PartNumbers& part : scene.parts) insets.push_back(part.cells);
        }
        const auto best_captions = clear_bests(captions, query_.comparison.better);
        const auto best_insets =
            clear_bests(insets, map_metric_ == nullptr ? Direction::None : map_metric_->better);
        std::size_t inset = 0;
        for (std::size_t s = 0; s < scenes.size(); ++s) {
            scenes[s].best = best_captions[s];
            if (scenes[s].crops_are_automatic) continue;
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
        block.note = short_name_of_metric(query_.comparison.metric) + ", " + ratio_words();
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
