// Ratios of errors to the baseline's: as bars in groups, and against a parameter.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/figure/axes.h"
#include "experiments/figure/colour_map.h"
#include "experiments/figure/grid.h"
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

const ComparedCell* measured(const Query& query, const std::string& scene,
                             const std::string& method) {
    const ComparedCell* cell = query.comparison.find(scene, method, query.budgets.front());
    return cell != nullptr && cell->ratio ? cell : nullptr;
}

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
    const Query query = ask(store, panel, true, false);
    std::vector<RatioPoint> points;
    std::vector<std::size_t> methods;  // of the points
    const std::size_t n_methods = query.methods.size();
    const double group = static_cast<double>(n_methods) + 1;
    for (std::size_t s = 0; s < query.scenes.size(); ++s) {
        for (std::size_t m = 0; m < n_methods; ++m) {
            const auto* cell = measured(query, query.scenes[s].name.value, query.methods[m]);
            if (cell == nullptr) continue;
            points.push_back(
                {group * static_cast<double>(s) + static_cast<double>(m), *cell->ratio});
            methods.push_back(m);
        }
    }
    const double y = top + draw_title(drawing, style, panel.title, top);
    const double height = std::min(0.5 * style.width, 130.0);
    const Box box{0, y, style.width, height};
    const double end = group * static_cast<double>(query.scenes.size()) - 1;
    const Plot plot(drawing, style, box, Axis{.low = -1, .high = end},
                    ratio_axis(points, ratio_label(query, panel)), "", false);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Point tip = plot.at(points[i].x - 0.4, points[i].ratio.value);
        const Point foot = plot.at(points[i].x + 0.4, 1);
        drawing.items.push_back(
            filled({tip.x, std::min(tip.y, foot.y), foot.x - tip.x, std::abs(foot.y - tip.y)},
                   series_colour(methods[i])));
        add_whisker(drawing, plot, points[i], kBlack);
    }
    add_one(drawing, plot);
    const double group_width = group * (plot.inner().width / (end + 1));
    for (std::size_t s = 0; s < query.scenes.size(); ++s) {
        add_fitting(drawing, style,
                    {.at = {plot.at(group * static_cast<double>(s) + group / 2 - 1, 1).x,
                            box.bottom() + style.small()},
                     .text = panel.title_of(query.scenes[s].name.value),
                     .size = style.small(),
                     .anchor = Anchor::Middle},
                    group_width - 2);
    }
    std::vector<LegendEntry> legend;
    for (std::size_t m = 0; m < n_methods; ++m) {
        if (std::ranges::find(methods, m) == methods.end()) continue;
        legend.push_back({panel.title_of(query.methods[m]), series_colour(m), 1});
    }
    const double legend_top = box.bottom() + 1.6 * style.small();
    return legend_top + draw_legend(drawing, style, legend, legend_top) - top;
}

double draw_sweep(Drawing& drawing, const Style& style, const Store& store, const Panel& panel,
                  double top) {
    const Query query = ask(store, panel, true, false);
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
            const auto* cell = measured(query, scene.name.value, query.methods[m]);
            if (cell != nullptr) points.push_back({xs[m], *cell->ratio});
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
            .dashes = {2.5, 1.5}});
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
