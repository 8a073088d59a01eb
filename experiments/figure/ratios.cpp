// Ratios of errors to the baseline's: as bars in groups, and against a parameter.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "experiments/figure/axes.h"
#include "experiments/figure/colour_map.h"
#include "experiments/figure/query.h"

namespace misbench::figure {
namespace {

struct RatioPoint {
    double x = 0;
    Estimate ratio;
};

std::string ratio_label(const Query& query, const Panel& panel) {
    return short_name_of_metric(query.comparison.metric) + " relative to " +
           panel.title_of(query.plan.baseline);
}

// Ratios and their ends, and 1.
Axis ratio_axis(const std::vector<RatioPoint>& points, const std::string& label) {
    std::vector<double> values{1};
    for (const RatioPoint& point : points) {
        values.push_back(point.ratio.value);
        if (point.ratio.interval) {
            values.insert(values.end(), {point.ratio.interval->low, point.ratio.interval->high});
        }
    }
    return axis_around(values, true, label);
}

void add_whisker(Drawing& drawing, const Plot& plot, const RatioPoint& point, Colour colour) {
    if (!point.ratio.interval) return;
    const Point low = plot.at(point.x, point.ratio.interval->low);
    const Point high = plot.at(point.x, point.ratio.interval->high);
    drawing.items.push_back(line(low, high, colour, 0.6));
    for (const Point& end : {low, high}) {
        drawing.items.push_back(line({end.x - 1.2, end.y}, {end.x + 1.2, end.y}, colour, 0.6));
    }
}

void add_one(Drawing& drawing, const Plot& plot) {
    drawing.items.push_back(line(plot.at(plot.x().low, 1), plot.at(plot.x().high, 1), kBlack, 0.6));
}

// To the baseline; absent where something is not measured.
std::optional<Estimate> ratio_of(const Query& query, const Budget& budget, const std::string& scene,
                                 const std::string& method) {
    const ComparedCell* cell = query.comparison.find(scene, method, budget);
    return cell == nullptr ? std::nullopt : cell->ratio;
}

// The names of scenes below bars in groups: turned where they would be too small to read otherwise.
class GroupNames {
 public:
    GroupNames(const Style& style, const Panel& panel, const std::vector<SceneEntry>& scenes,
               double group_width)
        : style_(style), group_width_(group_width) {
        for (const SceneEntry& scene : scenes) {
            names_.push_back(panel.title_of(scene.name.value));
            widest_ =
                std::max(widest_, text_width(style.typeface, names_.back(), style.small(), false));
        }
        is_turned_ = widest_ > 1.25 * group_width;
    }

    double height() const { return is_turned_ ? widest_ + 4 : 1.6 * style_.small(); }

    void draw(Drawing& drawing, std::size_t group, Point below) const {
        if (is_turned_) {
            drawing.items.push_back(Label{.at = {below.x + 0.35 * style_.small(), below.y + 2},
                                          .text = names_[group],
                                          .size = style_.small(),
                                          .anchor = Anchor::Right,
                                          .upwards = true});
            return;
        }
        add_fitting(drawing, style_,
                    {.at = {below.x, below.y + style_.small()},
                     .text = names_[group],
                     .size = style_.small(),
                     .anchor = Anchor::Middle},
                    group_width_ - 2);
    }

 private:
    const Style& style_;
    double group_width_;
    std::vector<std::string> names_;
    double widest_ = 0;
    bool is_turned_ = false;
};

// What the tasks of a method have as this parameter.
double parameter_of(const Query& query, const Placed<std::string>& parameter,
                    const std::string& method) {
    for (const Cell& cell : query.plan.cells) {
        if (cell.role != Role::Test || cell.method != method) continue;
        const auto found = cell.task.parameters.find(parameter.value);
        if (found == cell.task.parameters.end()) {
            std::string known;
            for (const auto& entry : cell.task.parameters) known += " " + entry.first;
            fail_at(parameter.place, fmt::format("method '{}' has no parameter '{}'; known:{}",
                                                 method, parameter.value, known));
        }
        if (const auto* real = std::get_if<double>(&found->second)) return *real;
        if (const auto* whole = std::get_if<std::int64_t>(&found->second)) {
            return static_cast<double>(*whole);
        }
    }
    fail_at(parameter.place, "parameter '" + parameter.value + "' is not a number");
}

}  // namespace

double draw_bars(Drawing& drawing, const Style& style, const Store& store, const Panel& panel,
                 double top) {
    const Query query = ask(store, panel, false);
    const Budget budget = budget_of(query, panel);
    std::vector<std::size_t> methods;  // those with a bar: not the baseline
    for (std::size_t m = 0; m < query.methods.size(); ++m) {
        if (query.methods[m] != query.plan.baseline) methods.push_back(m);
    }
    struct Bar {
        RatioPoint point;
        Colour colour;
    };
    std::vector<Bar> bars;
    std::vector<RatioPoint> points;
    const double group = static_cast<double>(methods.size()) + 1;
    for (std::size_t s = 0; s < query.scenes.size(); ++s) {
        for (std::size_t i = 0; i < methods.size(); ++i) {
            const auto ratio =
                ratio_of(query, budget, query.scenes[s].name.value, query.methods[methods[i]]);
            if (!ratio) continue;
            points.push_back({group * static_cast<double>(s) + static_cast<double>(i), *ratio});
            bars.push_back({points.back(), series_colour(methods[i])});
        }
    }
    const double y = top + draw_title(drawing, style, panel.title, top);
    const Box box{0, y, style.width, std::min(0.5 * style.width, 130.0)};
    const double end = group * static_cast<double>(query.scenes.size()) - 1;
    const Plot plot(drawing, style, box, Axis{.low = -1, .high = end},
                    ratio_axis(points, ratio_label(query, panel)), "", false);
    for (const Bar& bar : bars) {
        const Point tip = plot.at(bar.point.x - 0.4, bar.point.ratio.value);
        const Point foot = plot.at(bar.point.x + 0.4, 1);
        drawing.items.push_back(
            filled({tip.x, std::min(tip.y, foot.y), foot.x - tip.x, std::abs(foot.y - tip.y)},
                   bar.colour));
        add_whisker(drawing, plot, bar.point, kBlack);
    }
    add_one(drawing, plot);
    const GroupNames names(style, panel, query.scenes, group * (plot.inner().width / (end + 1)));
    for (std::size_t s = 0; s < query.scenes.size(); ++s) {
        const double x = plot.at(group * static_cast<double>(s) + group / 2 - 1, 1).x;
        names.draw(drawing, s, {x, plot.inner().bottom()});
    }
    std::vector<LegendEntry> legend;
    for (const std::size_t m : methods) {
        legend.push_back({panel.title_of(query.methods[m]), series_colour(m), 1});
    }
    const double legend_top = plot.inner().bottom() + names.height();
    return legend_top + draw_legend(drawing, style, legend, legend_top) - top;
}

double draw_sweep(Drawing& drawing, const Style& style, const Store& store, const Panel& panel,
                  double top) {
    const Query query = ask(store, panel, false);
    const Budget budget = budget_of(query, panel);
    const auto& sweep = std::get<SweepPanel>(panel.kind);
    std::vector<double> xs;
    for (const std::string& method : query.methods) {
        xs.push_back(parameter_of(query, sweep.parameter, method));
    }
    std::vector<std::vector<RatioPoint>> lines;
    std::vector<RatioPoint> all;
    for (const SceneEntry& scene : query.scenes) {
        std::vector<RatioPoint> points;
        for (std::size_t m = 0; m < query.methods.size(); ++m) {
            auto ratio = ratio_of(query, budget, scene.name.value, query.methods[m]);
            if (query.methods[m] == query.plan.baseline)
                ratio = Estimate{.value = 1, .interval = {}, .why_none = {}};
            if (ratio) points.push_back({xs[m], *ratio});
        }
        std::ranges::sort(points, {}, &RatioPoint::x);
        all.insert(all.end(), points.begin(), points.end());
        lines.push_back(std::move(points));
    }
    if (sweep.mark) xs.push_back(*sweep.mark);
    const bool logarithmic = std::ranges::all_of(xs, [](double x) { return x > 0; });
    const double y = top + draw_title(drawing, style, panel.title, top);
    const Box box{0, y, style.width, std::min(0.65 * style.width, 180.0)};
    const Plot plot(drawing, style, box,
                    axis_around(xs, logarithmic, panel.title_of(sweep.parameter.value)),
                    ratio_axis(all, ratio_label(query, panel)), "");
    add_one(drawing, plot);
    if (sweep.mark) {
        drawing.items.push_back(Shape{
            .points = {plot.at(*sweep.mark, plot.y().low), plot.at(*sweep.mark, plot.y().high)},
            .stroke = kGrey,
            .line_width = 0.8,
            .dashes = kDashes});
    }
    std::vector<LegendEntry> legend;
    for (std::size_t s = 0; s < lines.size(); ++s) {
        Shape curve{.stroke = series_colour(s), .line_width = 1};
        for (const RatioPoint& point : lines[s]) {
            curve.points.push_back(plot.at(point.x, point.ratio.value));
            add_whisker(drawing, plot, point, series_colour(s));
        }
        drawing.items.push_back(curve);
        for (const Point& point : curve.points) add_marker(drawing, point, s, series_colour(s));
        legend.push_back({panel.title_of(query.scenes[s].name.value), series_colour(s), s});
    }
    return box.bottom() + 2 + draw_legend(drawing, style, legend, box.bottom() + 2) - top;
}

}  // namespace misbench::figure
