#include "experiments/figure/axes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "renderer/base/check.h"

namespace misbench::figure {
namespace {

constexpr Colour kGrid{0.87, 0.87, 0.87};
constexpr double kSmallTick = 1.5;

std::string number(double value) {
    if (value == 0) return "0";
    const double size = std::abs(value);
    if (size >= 1e4 || size < 1e-3) {
        const double exponent = std::floor(std::log10(size) + 1e-9);
        const double digits = value / std::pow(10.0, exponent);
        return std::abs(digits - 1) < 1e-6 ? fmt::format("1e{:.0f}", exponent)
                                           : fmt::format("{:.3g}e{:.0f}", digits, exponent);
    }
    return fmt::format("{:.4g}", value);
}

std::vector<Tick> linear_ticks(const Axis& axis) {
    const double rough = (axis.high - axis.low) / 4;
    const double unit = std::pow(10.0, std::floor(std::log10(rough)));
    double step = 10 * unit;
    for (const double multiple : {5.0, 2.0, 1.0}) {
        if (multiple * unit >= rough) step = multiple * unit;
    }
    std::vector<Tick> all;
    for (double i = std::ceil(axis.low / step - 1e-9); i * step <= axis.high + 1e-9 * step; ++i) {
        all.push_back({i * step, number(i * step)});
    }
    return all;
}

std::vector<Tick> logarithmic_ticks(const Axis& axis) {
    const double decades = std::log10(axis.high / axis.low);
    const int skipped = std::max(1, static_cast<int>(decades / 5));
    std::vector<Tick> all;
    const int first = static_cast<int>(std::floor(std::log10(axis.low) + 1e-9));
    for (int exponent = first; std::pow(10.0, exponent) <= axis.high * (1 + 1e-9); ++exponent) {
        for (int digit = 1; digit < 10; ++digit) {
            const double value = digit * std::pow(10.0, exponent);
            if (value < axis.low * (1 - 1e-9) || value > axis.high * (1 + 1e-9)) continue;
            const bool is_labelled =
                digit == 1 ? exponent % skipped == 0
                           : decades < 1 || (decades < 2 && (digit == 2 || digit == 5));
            all.push_back({value, is_labelled ? number(value) : ""});
        }
    }
    return all;
}

}  // namespace

double Axis::position(double value) const {
    return logarithmic ? std::log(value / low) / std::log(high / low)
                       : (value - low) / (high - low);
}

std::vector<Tick> ticks(const Axis& axis) {
    if (!axis.logarithmic) return linear_ticks(axis);
    const std::vector<Tick> all = logarithmic_ticks(axis);
    const auto n_labels =
        std::ranges::count_if(all, [](const Tick& t) { return !t.label.empty(); });
    return n_labels < 2 ? linear_ticks(axis) : all;
}

Axis axis_around(std::span<const double> values, bool logarithmic, const std::string& label) {
    MISBENCH_CHECK(!values.empty());
    const auto [least, largest] = std::ranges::minmax_element(values);
    Axis axis{.low = *least, .high = *largest, .logarithmic = logarithmic, .label = label};
    if (logarithmic) {
        // A third of a factor two at least, so that equal values do not fill the plot with noise.
        const double room = std::max(std::pow(axis.high / axis.low, 0.06), 1.12);
        axis.low /= room;
        axis.high *= room;
    } else {
        const double room = std::max(0.06 * (axis.high - axis.low), 0.02 * std::abs(axis.high));
        axis.low -= room;
        axis.high += room;
        if (!(axis.low < axis.high)) axis.high = axis.low + 1;
    }
    return axis;
}

Plot::Plot(Drawing& drawing, const Style& style, const Box& outer, Axis x, Axis y,
           const std::string& title, bool x_ticks)
    : x_(std::move(x)), y_(std::move(y)) {
    const double small = style.small();
    double labels_width = 0;
    for (const Tick& tick : ticks(y_)) {
        labels_width = std::max(labels_width, text_width(style.typeface, tick.label, small, false));
    }
    const double left = labels_width + 3 + (y_.label.empty() ? 0 : 1.2 * small);
    const double above = title.empty() ? 0.4 * small : style.line_height();
    const double below = (x_ticks ? 1.3 * small : 2) + (x_.label.empty() ? 0 : 1.2 * small);
    inner_ = {outer.x + left, outer.y + above, outer.width - left - 0.5 * small,
              outer.height - above - below};
    auto& items = drawing.items;
    const auto label = [&](Point at, const std::string& text, Anchor anchor) {
        items.push_back(Label{.at = at, .text = text, .size = small, .anchor = anchor});
    };
    // Of labels that would touch the one before, only the line is drawn.
    double free_below = inner_.bottom() + small;
    for (const Tick& tick : ticks(y_)) {
        const double at_y = at(x_.low, tick.value).y;
        if (tick.label.empty()) {
            items.push_back(line({inner_.x, at_y}, {inner_.x + kSmallTick, at_y}, kBlack, 0.3));
            continue;
        }
        items.push_back(line({inner_.x, at_y}, {inner_.right(), at_y}, kGrid, 0.4));
        if (at_y + 0.5 * small > free_below) continue;
        label({inner_.x - 2, at_y + 0.33 * small}, tick.label, Anchor::Right);
        free_below = at_y - 0.5 * small;
    }
    double free_from = outer.x;
    for (const Tick& tick : x_ticks ? ticks(x_) : std::vector<Tick>{}) {
        const double at_x = at(tick.value, y_.low).x;
        const double bottom = inner_.bottom();
        if (tick.label.empty()) {
            items.push_back(line({at_x, bottom}, {at_x, bottom - kSmallTick}, kBlack, 0.3));
            continue;
        }
        items.push_back(line({at_x, inner_.y}, {at_x, bottom}, kGrid, 0.4));
        const double half = text_width(style.typeface, tick.label, small, false) / 2;
        if (at_x - half < free_from) continue;
        label({at_x, bottom + 1 + 0.95 * small}, tick.label, Anchor::Middle);
        free_from = at_x + half + 2;
    }
    items.push_back(frame(inner_, kBlack, 0.5));
    add_fitting(drawing, style,
                {.at = {inner_.centre().x, inner_.y - 0.35 * style.font_size},
                 .text = title,
                 .size = style.font_size,
                 .anchor = Anchor::Middle},
                inner_.width);
    add_fitting(drawing, style,
                {.at = {inner_.centre().x, outer.bottom() - 0.25 * small},
                 .text = x_.label,
                 .size = small,
                 .anchor = Anchor::Middle},
                inner_.width);
    add_fitting(drawing, style,
                {.at = {outer.x + 0.85 * small, inner_.centre().y},
                 .text = y_.label,
                 .size = small,
                 .anchor = Anchor::Middle,
                 .upwards = true},
                inner_.height);
}

Point Plot::at(double x, double y) const {
    return {inner_.x + inner_.width * x_.position(x),
            inner_.bottom() - inner_.height * y_.position(y)};
}

std::vector<Point> Plot::clipped(Point from, Point to) const {
    const Point a = at(from.x, from.y);
    const Point b = at(to.x, to.y);
    // Liang and Barsky's: the part of [0, 1] that is within all four sides.
    double first = 0;
    double last = 1;
    const auto clip = [&](double direction, double room) {
        if (direction == 0) {
            if (room < 0) last = -1;
        } else if (direction < 0) {
            first = std::max(first, room / direction);
        } else {
            last = std::min(last, room / direction);
        }
    };
    clip(a.x - b.x, a.x - inner_.x);
    clip(b.x - a.x, inner_.right() - a.x);
    clip(a.y - b.y, a.y - inner_.y);
    clip(b.y - a.y, inner_.bottom() - a.y);
    if (!(first < last)) return {};
    const auto point = [&](double t) {
        return Point{std::lerp(a.x, b.x, t), std::lerp(a.y, b.y, t)};
    };
    return {point(first), point(last)};
}

double draw_legend(Drawing& drawing, const Style& style, std::span<const LegendEntry> entries,
                   double top) {
    const double size = style.small();
    const double key = 8;
    const auto width_of = [&](const LegendEntry& entry) {
        return key + 2 + text_width(style.typeface, entry.text, size, false) + 8;
    };
    double y = top;
    for (std::size_t begin = 0; begin < entries.size();) {
        double width = 0;
        std::size_t end = begin;
        while (end < entries.size() &&
               (end == begin || width + width_of(entries[end]) <= style.width)) {
            width += width_of(entries[end++]);
        }
        double x = std::max(0.0, (style.width - (width - 8)) / 2);
        for (; begin < end; ++begin) {
            const LegendEntry& entry = entries[begin];
            const double middle = y + 0.62 * size;
            Shape shape = line({x, middle}, {x + key, middle}, entry.colour, 1);
            if (!entry.marker) shape.dashes = kDashes;
            drawing.items.push_back(std::move(shape));
            if (entry.marker) {
                add_marker(drawing, {x + key / 2, middle}, *entry.marker, entry.colour);
            }
            drawing.items.push_back(
                Label{.at = {x + key + 2, y + 0.95 * size}, .text = entry.text, .size = size});
            x += width_of(entry);
        }
        y += 1.35 * size;
    }
    return y - top;
}

void add_marker(Drawing& drawing, Point at, std::size_t index, Colour colour) {
    constexpr double kRadius = 1.5;
    // Disk, square, triangle, diamond, triangle on its tip, pentagon.
    constexpr std::array kCorners = {16, 4, 3, 4, 3, 5};
    constexpr std::array kTurns = {0.0, 0.125, 0.25, 0.0, 0.75, 0.25};  // of the first corner
    const std::size_t kind = index % kCorners.size();
    const bool is_hollow = index / kCorners.size() % 2 == 1;
    Shape shape{.closed = true, .fill = is_hollow ? kWhite : colour, .stroke = colour};
    for (int i = 0; i < kCorners[kind]; ++i) {
        const double angle =
            2 * std::numbers::pi * (kTurns[kind] + static_cast<double>(i) / kCorners[kind]);
        shape.points.push_back(
            {at.x + kRadius * std::cos(angle), at.y - kRadius * std::sin(angle)});
    }
    drawing.items.push_back(std::move(shape));
}

}  // namespace misbench::figure
