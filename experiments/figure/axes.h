// Axes of plots: where values lie, what is written beside them, and the frame around.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiments/figure/drawing.h"
#include "experiments/figure/figure.h"

namespace misbench::figure {

struct Axis {
    double low = 0;
    double high = 1;
    bool logarithmic = false;
    std::string label = {};

    double position(double value) const;  // 0 at low, 1 at high
};

struct Tick {
    double value = 0;
    std::string label;  // "" for a small one
};
// Within the axis, two labels at least; of a logarithmic one the powers of ten and small ticks
// between, or 1, 2, 5 of each where there are few decades, or even steps where there is hardly one.
std::vector<Tick> ticks(const Axis& axis);

// An axis around all of the values, with some room at both ends. REQUIRES: values are not empty,
// and positive for a logarithmic axis.
Axis axis_around(std::span<const double> values, bool logarithmic, const std::string& label);

// A frame with axes, in which values have their places.
class Plot {
 public:
    // `outer` holds the tick labels and the axes' names as well.
    Plot(Drawing& drawing, const Style& style, const Box& outer, Axis x, Axis y,
         const std::string& title, bool x_ticks = true);

    const Box& inner() const { return inner_; }
    const Axis& x() const { return x_; }
    const Axis& y() const { return y_; }
    Point at(double x, double y) const;
    // Of the part of a straight line (in the axes' scales) that lies within the frame, both ends.
    std::vector<Point> clipped(Point from, Point to) const;

 private:
    Box inner_;
    Axis x_;
    Axis y_;
};

inline const std::vector<double> kDashes = {2, 1.5};

struct LegendEntry {
    std::string text;
    Colour colour;
    std::optional<std::size_t> marker;  // absent: the line is dashed
};
// In lines centred at `top`, as many as are needed; returns the height.
double draw_legend(Drawing& drawing, const Style& style, std::span<const LegendEntry> entries,
                   double top);

// A small mark for readers who see no colours: of six shapes in turn, then the same hollow.
void add_marker(Drawing& drawing, Point at, std::size_t index, Colour colour);

}  // namespace misbench::figure
