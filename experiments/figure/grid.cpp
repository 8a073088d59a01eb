#include "experiments/figure/grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/figure/axes.h"
#include "experiments/figure/colour_map.h"
#include "renderer/base/check.h"
#include "renderer/base/error.h"

namespace misbench::figure {
namespace {

constexpr double kGap = 2;        // between cells
constexpr double kFullGap = 4;    // between the whole image and its crops
constexpr double kBlockGap = 5;   // between scenes
constexpr double kFrame = 1;      // of crops and marks
constexpr double kPadding = 1.2;  // of text within a cell
constexpr double kBarHeight = 5;
constexpr double kLeastColumn = 8;
constexpr Colour kMissing{0.88, 0.88, 0.88};

double aspect_of(const Raster& raster) { return static_cast<double>(raster.width) / raster.height; }

// Where the columns of all blocks are.
struct Columns {
    double left = 0;
    double width = 0;
    std::size_t count = 0;

    double x(std::size_t column) const {
        return left + static_cast<double>(column) * (width + kGap);
    }
    double span() const { return static_cast<double>(count) * (width + kGap) - kGap; }
};

double height_of_rows(const SceneBlock& block, double column_width) {
    double height = 0;
    for (const GridRow& row : block.rows) height += column_width / row.aspect + kGap;
    return height - kGap;
}

// So wide that the block's image, as high as its rows, and the columns fill the width. With h = c S
// + (R - 1) g for R rows of columns c wide: A h + G + n c + (n - 1) g = W.
double column_width(const SceneBlock& block, std::size_t n, double side, double total) {
    const auto columns = static_cast<double>(n);
    const double gaps = (columns - 1) * kGap;
    if (!block.full) return (total - side - gaps) / columns;
    double inverse_aspects = 0;
    for (const GridRow& row : block.rows) inverse_aspects += 1 / row.aspect;
    const double aspect = aspect_of(*block.full);
    const double row_gaps = (static_cast<double>(block.rows.size()) - 1) * kGap;
    return (total - aspect * row_gaps - kFullGap - gaps) / (aspect * inverse_aspects + columns);
}

// Titles of scenes without a whole image stand at the side, turned.
double side_of(const Grid& grid, const Style& style) {
    const auto needs_it = [](const SceneBlock& b) { return !b.full && !b.title.empty(); };
    return std::ranges::any_of(grid.blocks, needs_it) ? style.line_height() : 0;
}

Columns place_columns(const Grid& grid, const Style& style, std::size_t room_for) {
    Columns columns{.left = 0, .width = style.width, .count = grid.columns.size()};
    const std::size_t n = std::max(room_for, columns.count);
    for (const SceneBlock& block : grid.blocks) {
        columns.width =
            std::min(columns.width, column_width(block, n, side_of(grid, style), style.width));
    }
    if (columns.width < kLeastColumn) {
        throw Error(Errc::InvalidArgument,
                    fmt::format("draw a figure: {} columns of images do not fit into {:.0f} pt", n,
                                style.width));
    }
    columns.left = n > columns.count ? side_of(grid, style) : style.width - columns.span();
    return columns;
}

// One size for texts that stand beside each other, so that all fit.
class CommonSize {
 public:
    CommonSize(const Typeface& typeface, double size, double room)
        : typeface_(typeface), size_(size), room_(room) {}

    void hold(const GridText& text) {
        const double width = text_width(typeface_, text.text, size_, text.bold);
        if (width > room_) size_ *= room_ / width;
    }
    double size() const { return size_; }

 private:
    const Typeface& typeface_;
    double size_;
    double room_;
};

struct TextSizes {
    double titles;
    double captions;
    double insets;
};

TextSizes text_sizes(const Grid& grid, const Style& style, double column_width) {
    CommonSize titles(style.typeface, style.font_size, column_width);
    CommonSize captions(style.typeface, style.small(), column_width);
    CommonSize insets(style.typeface, style.small(), column_width - 2 * (kFrame + kPadding));
    for (const std::string& title : grid.columns) titles.hold({title});
    for (const SceneBlock& block : grid.blocks) {
        for (const auto& column : block.captions) {
            for (const GridText& text : column) captions.hold(text);
        }
        for (const GridRow& row : block.rows) {
            for (const GridCell& cell : row.cells) insets.hold(cell.inset);
        }
    }
    return {titles.size(), captions.size(), insets.size()};
}

void add_inset(Drawing& drawing, const Style& style, const Box& cell, const GridText& inset,
               double size) {
    if (inset.text.empty()) return;
    const double width = text_width(style.typeface, inset.text, size, inset.bold);
    const Box field{cell.x + kFrame, cell.bottom() - kFrame - 1.15 * size, width + 2 * kPadding,
                    1.15 * size};
    drawing.items.push_back(filled(field, kBlack, 0.6));
    drawing.items.push_back(Label{.at = {field.x + kPadding, field.bottom() - 0.3 * size},
                                  .text = inset.text,
                                  .size = size,
                                  .bold = inset.bold,
                                  .colour = kWhite});
}

void add_cell(Drawing& drawing, const Style& style, const Box& box, const GridCell& cell,
              double inset_size) {
    if (cell.is_blank) return;
    if (cell.raster) {
        drawing.items.push_back(Picture{box, *cell.raster, cell.description});
    } else {
        drawing.items.push_back(filled(box, kMissing));
        add_fitting(drawing, style,
                    {.at = {box.centre().x, box.centre().y + 0.35 * style.small()},
                     .text = cell.missing,
                     .size = style.small(),
                     .anchor = Anchor::Middle},
                    box.width);
    }
    if (cell.frame) drawing.items.push_back(frame(box, *cell.frame, kFrame));
    add_inset(drawing, style, box, cell.inset, inset_size);
}

void add_full(Drawing& drawing, const Style& style, const Box& box, const SceneBlock& block) {
    const Raster& full = *block.full;
    drawing.items.push_back(Picture{box, full, block.title});
    for (const Mark& mark : block.marks) {
        const double scale = box.width / full.width;
        drawing.items.push_back(frame({box.x + scale * mark.window.x, box.y + scale * mark.window.y,
                                       scale * mark.window.width, scale * mark.window.height},
                                      mark.colour, kFrame));
    }
    if (block.full_labels.size() < 2) return;
    const double middle = box.x + box.width * (full.width / 2) / full.width;
    drawing.items.push_back(line({middle, box.y}, {middle, box.bottom()}, kWhite, 0.75));
    CommonSize size(style.typeface, style.small(), box.width / 2 - 2 * (kFrame + kPadding));
    for (const std::string& text : block.full_labels) size.hold({text});
    add_inset(drawing, style, {box.x, box.y, middle - box.x, box.height}, {block.full_labels[0]},
              size.size());
    add_inset(drawing, style, {middle, box.y, box.right() - middle, box.height},
              {block.full_labels[1]}, size.size());
}

// The title and the note, beside the captions; returns the height of both.
double add_captions(Drawing& drawing, const Style& style, const SceneBlock& block,
                    const Columns& columns, double size, double top) {
    const double step = 1.2 * style.small();
    std::size_t n_lines = 0;
    for (std::size_t c = 0; c < block.captions.size(); ++c) {
        n_lines = std::max(n_lines, block.captions[c].size());
        for (std::size_t i = 0; i < block.captions[c].size(); ++i) {
            drawing.items.push_back(Label{.at = {columns.x(c) + columns.width / 2,
                                                 top + step * (static_cast<double>(i) + 0.95)},
                                          .text = block.captions[c][i].text,
                                          .size = size,
                                          .anchor = Anchor::Middle,
                                          .bold = block.captions[c][i].bold});
        }
    }
    double height = step * static_cast<double>(n_lines);
    if (!block.full) return height;
    const double room = columns.left - kFullGap;
    add_fitting(drawing, style,
                {.at = {0, top + 0.95 * step}, .text = block.title, .size = style.font_size}, room);
    if (!block.note.empty()) {
        add_fitting(drawing, style,
                    {.at = {0, top + 1.95 * step}, .text = block.note, .size = style.small()},
                    room);
    }
    return std::max(height, step * (block.note.empty() ? 1.25 : 2.25));
}

double add_block(Drawing& drawing, const Style& style, const SceneBlock& block,
                 const Columns& columns, const TextSizes& sizes, double top) {
    const double height = height_of_rows(block, columns.width);
    if (block.full) {
        const double room = columns.left - kFullGap;
        const double width = std::min(room, height * aspect_of(*block.full));
        add_full(drawing, style, {room - width, top, width, width / aspect_of(*block.full)}, block);
    } else if (!block.title.empty()) {
        add_fitting(drawing, style,
                    {.at = {columns.left - 0.45 * style.font_size, top + height / 2},
                     .text = block.title,
                     .size = style.font_size,
                     .anchor = Anchor::Middle,
                     .upwards = true},
                    height);
    }
    double y = top;
    for (const GridRow& row : block.rows) {
        MISBENCH_CHECK(row.cells.size() == columns.count);
        const double row_height = columns.width / row.aspect;
        for (std::size_t c = 0; c < row.cells.size(); ++c) {
            add_cell(drawing, style, {columns.x(c), y, columns.width, row_height}, row.cells[c],
                     sizes.insets);
        }
        y += row_height + kGap;
    }
    return height + add_captions(drawing, style, block, columns, sizes.captions, top + height);
}

double add_bar(Drawing& drawing, const Style& style, const ColourBar& bar, const Columns& columns,
               double top) {
    constexpr int kSteps = 256;
    Raster ramp{kSteps, 1, {}};
    ValueMap values{kSteps, 1, {}};
    for (int i = 0; i < kSteps; ++i) values.values.push_back((i + 0.5) / kSteps);
    ramp = to_raster(values, {0, 1, false});
    const double label_width =
        text_width(style.typeface, bar.label, style.small(), false) + style.small();
    const double left =
        std::max(columns.left, std::min(label_width, columns.left + 0.5 * columns.span()));
    const Box box{left, top, style.width - left, kBarHeight};
    drawing.items.push_back(Picture{box, ramp, "colour bar: " + bar.label});
    add_fitting(drawing, style,
                {.at = {left - 0.5 * style.small(), top + kBarHeight},
                 .text = bar.label,
                 .size = style.small(),
                 .anchor = Anchor::Right},
                left);
    const Axis axis{
        .low = bar.scale.low, .high = bar.scale.high, .logarithmic = bar.scale.logarithmic};
    double free_from = 0;
    for (const Tick& tick : ticks(axis)) {
        if (tick.label.empty()) continue;
        const double x = box.x + box.width * axis.position(tick.value);
        drawing.items.push_back(line({x, box.bottom()}, {x, box.bottom() + 1.5}, kBlack, 0.4));
        const double half = text_width(style.typeface, tick.label, style.small(), false) / 2;
        const double middle = std::clamp(x, box.x + half, style.width - half);
        if (middle - half < free_from) continue;
        free_from = middle + half + 2;
        drawing.items.push_back(Label{.at = {middle, box.bottom() + 2 + 0.8 * style.small()},
                                      .text = tick.label,
                                      .size = style.small(),
                                      .anchor = Anchor::Middle});
    }
    return kBarHeight + 2 + 1.2 * style.small();
}

}  // namespace

double draw_grid(Drawing& drawing, const Style& style, const Grid& grid, double top,
                 std::size_t room_for) {
    const Columns columns = place_columns(grid, style, room_for);
    const TextSizes sizes = text_sizes(grid, style, columns.width);
    double y = top + draw_title(drawing, style, grid.title, top);
    if (std::ranges::any_of(grid.columns, [](const std::string& t) { return !t.empty(); })) {
        for (std::size_t c = 0; c < grid.columns.size(); ++c) {
            drawing.items.push_back(
                Label{.at = {columns.x(c) + columns.width / 2, y + style.font_size},
                      .text = grid.columns[c],
                      .size = sizes.titles,
                      .anchor = Anchor::Middle});
        }
        y += 1.1 * style.line_height();
    }
    for (const SceneBlock& block : grid.blocks) {
        y += add_block(drawing, style, block, columns, sizes, y) + kBlockGap;
    }
    if (grid.bar) {
        y += add_bar(drawing, style, *grid.bar, columns, y);
    } else {
        y -= kBlockGap;
    }
    for (const std::string& note : grid.notes) {
        y += 1.2 * style.small();
        add_fitting(drawing, style, {.at = {0, y}, .text = note, .size = style.small()},
                    style.width);
    }
    if (!grid.notes.empty()) y += 0.3 * style.small();
    return y - top;
}

}  // namespace misbench::figure
