// Images in a grid, as papers show them: for each scene the whole image with coloured boxes on the
// left, its crops by method on the right, errors below, one colour bar for all.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/figure/drawing.h"
#include "experiments/figure/figure.h"
#include "experiments/figure/raster.h"

namespace misbench::figure {

struct GridText {
    std::string text = {};
    bool bold = false;
};

struct GridCell {
    std::optional<Raster> raster = {};  // absent: a grey field
    std::string missing = "no run";     // what is written there
    std::string description = {};
    GridText inset = {};  // written over its lower left corner
    std::optional<Colour> frame = {};
    bool is_blank = false;  // has nothing at all
};

struct GridRow {
    double aspect = 1;  // width over height of its cells
    std::vector<GridCell> cells;
};

struct Mark {
    Window window;  // of the whole image
    Colour colour;
};

struct SceneBlock {
    std::string title = {};
    std::optional<Raster> full = {};
    std::vector<std::string> full_labels = {};  // one for each part of an image that several share
    std::vector<Mark> marks = {};
    std::string note = {};  // below the title: what the captions are
    std::vector<GridRow> rows = {};
    std::vector<std::vector<GridText>> captions = {};  // by column, then line
};

struct ColourBar {
    ColourScale scale;
    std::string label;
};

struct Grid {
    std::string title = {};
    std::vector<std::string> columns = {};
    std::vector<SceneBlock> blocks = {};
    std::optional<ColourBar> bar = {};
    std::vector<std::string> notes = {};  // a line each, below all
};

// Returns the height. The grid is as wide as the style says; all columns have one width, that of
// `room_for` columns where there are fewer. Throws InvalidArgument where that is too little to see.
double draw_grid(Drawing& drawing, const Style& style, const Grid& grid, double top,
                 std::size_t room_for = 0);
}  // namespace misbench::figure
