// Error against effort: convergence and Pareto plots, a plot for each scene.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/analysis/convergence.h"
#include "experiments/figure/axes.h"
#include "experiments/figure/colour_map.h"
#include "experiments/figure/query.h"

namespace misbench::figure {
namespace {

constexpr std::size_t kMostAcross = 4;

struct Series {
    std::string method;
    std::size_t index = 0;  // of its colour
    std::vector<double> x;
    std::vector<Estimate> y;
};

double effort_of(const CurvePoint& point, Effort effort) {
    switch (effort) {
        case Effort::Cpu:
            return point.cpu_seconds;
        case Effort::Wall:
            return point.wall_seconds;
        case Effort::Passes:
            return point.passes;
    }
    return 0;
}

std::string name_of(Effort effort) {
    return effort == Effort::Passes ? "samples a pixel"
           : effort == Effort::Cpu  ? "CPU seconds"
                                    : "seconds";
}

std::vector<Series> series_of(const std::vector<Curve>& curves, const Query& query,
                              const std::string& scene, Effort effort) {
    std::vector<Series> all;
    for (std::size_t m = 0; m < query.methods.size(); ++m) {
        Series series{.method = query.methods[m], .index = m, .x = {}, .y = {}};
        for (const Curve& curve : curves) {
            if (curve.scene != scene || curve.method != query.methods[m]) continue;
            for (const CurvePoint& point : curve.points) {
                const double x = effort_of(point, effort);
                // What is not positive has no place on a logarithmic axis.
                if (!point.mean || point.mean->value <= 0 || x <= 0) continue;
                series.x.push_back(x);
                series.y.push_back(*point.mean);
            }
        }
        if (!series.x.empty()) all.push_back(std::move(series));
    }
    return all;
}

// The ends of an estimate that can be drawn: not below `least`.
Interval drawn(const Estimate& estimate, double least) {
    if (!estimate.interval) return {estimate.value, estimate.value};
    return {std::max(estimate.interval->low, least), estimate.interval->high};
}

void add_interval_bar(Drawing& drawing, const Plot& plot, double x, const Interval& y,
                      Colour colour) {
    for (const Point& end : {plot.at(x, y.low), plot.at(x, y.high)}) {
        drawing.items.push_back(line({end.x - 1.2, end.y}, {end.x + 1.2, end.y}, colour, 0.5));
    }
    drawing.items.push_back(line(plot.at(x, y.low), plot.at(x, y.high), colour, 0.5));
}

void add_curve(Drawing& drawing, const Plot& plot, const Series& series) {
    const Colour colour = series_colour(series.index);
    Shape band{.closed = true, .fill = colour, .fill_opacity = 0.2};
    Shape curve{.stroke = colour, .line_width = 1};
    const double least = plot.y().low;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
        curve.points.push_back(plot.at(series.x[i], series.y[i].value));
        band.points.push_back(plot.at(series.x[i], drawn(series.y[i], least).high));
    }
    for (std::size_t i = series.x.size(); i-- > 0;) {
        band.points.push_back(plot.at(series.x[i], drawn(series.y[i], least).low));
    }
    if (series.x.size() > 1) drawing.items.push_back(std::move(band));
    drawing.items.push_back(curve);
    for (const Point& point : curve.points) add_marker(drawing, point, series.index, colour);
}

// From the first point of the first curve: error that falls as one over the effort.
void add_slope(Drawing& drawing, const Plot& plot, const std::vector<Series>& all) {
    const double x = all.front().x.front();
    const double y = all.front().y.front().value;
    const double factor = plot.x().high / x;
    const std::vector<Point> ends = plot.clipped({x, y}, {plot.x().high, y / factor});
    if (ends.empty()) return;
    drawing.items.push_back(
        Shape{.points = ends, .stroke = kGrey, .line_width = 0.6, .dashes = kDashes});
}

// A staircase through the points that no other beats in both effort and error.
void add_front(Drawing& drawing, const Plot& plot, const std::vector<Series>& all) {
    std::vector<Point> points;
    for (const Series& series : all) {
        for (std::size_t i = 0; i < series.x.size(); ++i) {
            points.push_back({series.x[i], series.y[i].value});
        }
    }
    std::ranges::sort(points, [](const Point& a, const Point& b) {
        return std::pair(a.x, a.y) < std::pair(b.x, b.y);
    });
    Shape stairs{.stroke = kGrey, .line_width = 0.6};
    double least = plot.y().high;
    for (const Point& point : points) {
        if (point.y >= least) continue;
        stairs.points.push_back(plot.at(point.x, least));
        stairs.points.push_back(plot.at(point.x, point.y));
        least = point.y;
    }
    stairs.points.push_back(plot.at(plot.x().high, least));
    drawing.items.push_back(std::move(stairs));
}

void draw_plot(Drawing& drawing, const Style& style, const Box& box, const Query& query,
               const std::vector<Series>& all, const EffortPanel& panel, const std::string& title,
               bool is_first) {
    std::vector<double> xs;
    std::vector<double> ys;
    for (const Series& series : all) {
        xs.insert(xs.end(), series.x.begin(), series.x.end());
        for (const Estimate& y : series.y) {
            const Interval ends = drawn(y, y.value / 10);
            ys.insert(ys.end(), {ends.low, ends.high});
        }
    }
    if (xs.empty()) {
        add_fitting(drawing, style,
                    {.at = box.centre(),
                     .text = title + ": no run",
                     .size = style.font_size,
                     .anchor = Anchor::Middle},
                    box.width);
        return;
    }
    const Plot plot(
        drawing, style, box, axis_around(xs, true, name_of(panel.effort)),
        axis_around(ys, true,
                    is_first ? short_name_of_metric(query.comparison.metric) : std::string()),
        title);
    if (panel.pareto) add_front(drawing, plot, all);
    if (!panel.pareto) add_slope(drawing, plot, all);
    for (const Series& series : all) {
        if (!panel.pareto) {
            add_curve(drawing, plot, series);
            continue;
        }
        for (std::size_t i = 0; i < series.x.size(); ++i) {
            const Colour colour = series_colour(series.index);
            add_interval_bar(drawing, plot, series.x[i], drawn(series.y[i], plot.y().low), colour);
            add_marker(drawing, plot.at(series.x[i], series.y[i].value), series.index, colour);
        }
    }
}

}  // namespace

double draw_effort(Drawing& drawing, const Style& style, const Store& store, const Panel& panel,
                   double top) {
    const Query query = ask(store, panel, false);
    const std::vector<Curve> curves = convergence(store, query.plan, query.comparison.metric);
    const auto& effort = std::get<EffortPanel>(panel.kind);
    double y = top + draw_title(drawing, style, panel.title, top);
    const std::size_t across = std::min(kMostAcross, query.scenes.size());
    const double width = style.width / static_cast<double>(across);
    const double height = std::min(0.8 * width, 150.0) + 2 * style.line_height();
    for (std::size_t s = 0; s < query.scenes.size(); ++s) {
        const std::string& scene = query.scenes[s].name.value;
        const Box box{width * static_cast<double>(s % across),
                      y + height * static_cast<double>(s / across), width, height};
        draw_plot(drawing, style, box, query, series_of(curves, query, scene, effort.effort),
                  effort, panel.title_of(scene), s % across == 0);
    }
    y += height * static_cast<double>((query.scenes.size() + across - 1) / across);
    std::vector<LegendEntry> legend;
    for (std::size_t m = 0; m < query.methods.size(); ++m) {
        legend.push_back({panel.title_of(query.methods[m]), series_colour(m), m});
    }
    if (!effort.pareto)
        legend.push_back({effort.effort == Effort::Passes ? "1/samples" : "1/time", kGrey, {}});
    return y + draw_legend(drawing, style, legend, y + 2) + 2 - top;
}

}  // namespace misbench::figure
