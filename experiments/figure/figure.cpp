#include "experiments/figure/figure.h"

namespace misbench::figure {
namespace {

constexpr double kPanelGap = 8;

double draw_panel(Drawing& drawing, const Style& style, const Store& store, const Panel& panel,
                  double top) {
    if (std::holds_alternative<ComparisonPanel>(panel.kind)) {
        return draw_comparison(drawing, style, store, panel, top);
    }
    if (std::holds_alternative<EffortPanel>(panel.kind)) {
        return draw_effort(drawing, style, store, panel, top);
    }
    if (std::holds_alternative<BarsPanel>(panel.kind)) {
        return draw_bars(drawing, style, store, panel, top);
    }
    if (std::holds_alternative<SweepPanel>(panel.kind)) {
        return draw_sweep(drawing, style, store, panel, top);
    }
    return draw_layers(drawing, style, panel, top);
}

}  // namespace

Drawing make_figure(const Store& store, const FigureFile& file, const Typeface& typeface) {
    const Style style{.width = file.width, .font_size = file.font_size, .typeface = typeface};
    Drawing drawing{.width = file.width, .height = 0, .items = {}};
    for (const Panel& panel : file.panels) {
        if (drawing.height > 0) drawing.height += kPanelGap;
        drawing.height += draw_panel(drawing, style, store, panel, drawing.height);
    }
    return drawing;
}

void add_fitting(Drawing& drawing, const Style& style, Label label, double width) {
    if (label.text.empty()) return;
    const double needed = text_width(style.typeface, label.text, label.size, label.bold);
    if (needed > width) label.size *= width / needed;
    drawing.items.push_back(std::move(label));
}

double draw_title(Drawing& drawing, const Style& style, const std::string& title, double top) {
    if (title.empty()) return 0;
    add_fitting(drawing, style,
                {.at = {style.width / 2, top + style.font_size},
                 .text = title,
                 .size = style.font_size,
                 .anchor = Anchor::Middle,
                 .bold = true},
                style.width);
    return 1.2 * style.line_height();
}

}  // namespace misbench::figure
