// What a drawing consists of, for tests.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "experiments/figure/drawing.h"
#include "experiments/figure/typeface.h"

namespace misbench::figure {

template <typename T>
std::vector<T> items_of(const Drawing& drawing) {
    std::vector<T> found;
    for (const Item& item : drawing.items) {
        if (const T* one = std::get_if<T>(&item)) found.push_back(*one);
    }
    return found;
}

inline std::vector<std::string> texts_of(const Drawing& drawing) {
    std::vector<std::string> texts;
    for (const Label& label : items_of<Label>(drawing)) texts.push_back(label.text);
    return texts;
}

inline const Label* find_label(const Drawing& drawing, const std::string& text) {
    for (const Item& item : drawing.items) {
        const Label* label = std::get_if<Label>(&item);
        if (label != nullptr && label->text.find(text) != std::string::npos) return label;
    }
    return nullptr;
}

inline Box box_of(const Shape& shape) {
    Box box{shape.points[0].x, shape.points[0].y, 0, 0};
    for (const Point& p : shape.points) {
        box.width = std::max(box.width, p.x - box.x);
        box.height = std::max(box.height, p.y - box.y);
    }
    return box;
}

// The box of a label's text, but for what its letters have below the line.
inline Box box_of(const Label& label, const Typeface& typeface) {
    const double width = text_width(typeface, label.text, label.size, label.bold);
    const double shift = width * (static_cast<int>(label.anchor) / 2.0);
    const double height = 0.75 * label.size;
    if (label.upwards) return {label.at.x - height, label.at.y - width + shift, height, width};
    return {label.at.x - shift, label.at.y - height, width, height};
}

inline Raster plain_raster(int width, int height, std::uint8_t value = 128) {
    return {width, height,
            std::vector<std::uint8_t>(static_cast<std::size_t>(3 * width * height), value)};
}

inline bool overlap(const Box& a, const Box& b) {
    constexpr double kRounding = 1e-6;
    return a.x < b.right() - kRounding && b.x < a.right() - kRounding &&
           a.y < b.bottom() - kRounding && b.y < a.bottom() - kRounding;
}

}  // namespace misbench::figure
