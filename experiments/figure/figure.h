// A figure, made anew from its file and the store.
#pragma once

#include "experiments/figure/drawing.h"
#include "experiments/figure/figure_file.h"
#include "experiments/figure/typeface.h"
#include "results/store.h"

namespace misbench::figure {

// What panels are drawn with.
struct Style {
    double width = kColumnWidth;
    double font_size = 7;
    Typeface typeface;

    double line_height() const { return 1.25 * font_size; }
    double small() const { return 0.85 * font_size; }  // captions, ticks
};

// Throws InvalidArgument, with the place in the figure's file, for what the experiment does not
// have. Where a run is not finished, the figure says so.
Drawing make_figure(const Store& store, const FigureFile& file, const Typeface& typeface);

// One panel each: appended to the drawing at `top`; returns its height.
double draw_comparison(Drawing& drawing, const Style& style, const Store& store, const Panel& panel,
                       double top);
double draw_effort(Drawing& drawing, const Style& style, const Store& store, const Panel& panel,
                   double top);
double draw_bars(Drawing& drawing, const Style& style, const Store& store, const Panel& panel,
                 double top);
double draw_sweep(Drawing& drawing, const Style& style, const Store& store, const Panel& panel,
                  double top);
double draw_layers(Drawing& drawing, const Style& style, const Panel& panel, double top);

// A line of text, made smaller where it would be wider than `width`.
void add_fitting(Drawing& drawing, const Style& style, Label label, double width);

// A panel's title, in bold above it; 0 for none.
double draw_title(Drawing& drawing, const Style& style, const std::string& title, double top);

}  // namespace misbench::figure
