// A figure as a list of what is drawn, later items over earlier ones: what layouts make, tests look
// at and writers turn into a file. All lengths are PostScript points (72 an inch) from the upper
// left corner, y downwards.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "experiments/figure/raster.h"

namespace misbench::figure {

struct Point {
    double x = 0;
    double y = 0;
};

struct Box {
    double x = 0;
    double y = 0;
    double width = 0;
    double height = 0;

    double right() const { return x + width; }
    double bottom() const { return y + height; }
    Point centre() const { return {x + width / 2, y + height / 2}; }
};

// In sRGB's encoding, each within [0, 1].
struct Colour {
    double red = 0;
    double green = 0;
    double blue = 0;
    bool operator==(const Colour&) const = default;
};
inline constexpr Colour kBlack{};
inline constexpr Colour kWhite{1, 1, 1};
inline constexpr Colour kGrey{0.5, 0.5, 0.5};

// Pixels are magnified without smoothing.
struct Picture {
    Box box;
    Raster raster;
    std::string description;  // for readers who cannot see it
};

enum class Anchor { Left, Middle, Right };

// One line of text; its baseline runs through `at`.
struct Label {
    Point at;
    std::string text;
    double size = 7;
    Anchor anchor = Anchor::Left;
    bool bold = false;
    bool upwards = false;  // turned by a quarter, to be read from below
    Colour colour = kBlack;
};

struct Shape {
    std::vector<Point> points = {};
    bool closed = false;
    std::optional<Colour> fill = {};
    double fill_opacity = 1;
    std::optional<Colour> stroke = {};
    double line_width = 0.5;
    std::vector<double> dashes = {};  // lengths of lines and gaps; empty for a solid line
};

using Item = std::variant<Picture, Shape, Label>;

struct Drawing {
    double width = 0;
    double height = 0;
    std::vector<Item> items;
};

inline std::vector<Point> corners(const Box& box) {
    return {
        {box.x, box.y}, {box.right(), box.y}, {box.right(), box.bottom()}, {box.x, box.bottom()}};
}

inline Shape line(Point from, Point to, Colour colour, double line_width) {
    return {.points = {from, to}, .stroke = colour, .line_width = line_width};
}

// A frame whose stroke lies within the box.
inline Shape frame(const Box& box, Colour colour, double line_width) {
    const double half = line_width / 2;
    return {.points = corners(
                {box.x + half, box.y + half, box.width - line_width, box.height - line_width}),
            .closed = true,
            .stroke = colour,
            .line_width = line_width};
}

inline Shape filled(const Box& box, Colour colour, double opacity = 1) {
    return {.points = corners(box), .closed = true, .fill = colour, .fill_opacity = opacity};
}

}  // namespace misbench::figure
