// The layers of an EXR file: maps of factors and weights in false colours, techniques as images.
#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "experiments/figure/grid.h"
#include "experiments/figure/query.h"

namespace misbench::figure {
namespace {

constexpr double kRowGap = 3;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// With numbers in names as numbers: connect2 before connect10.
bool is_before(std::string_view a, std::string_view b) {
    while (!a.empty() && !b.empty()) {
        if (!is_digit(a.front()) || !is_digit(b.front())) {
            if (a.front() != b.front()) return a.front() < b.front();
            a.remove_prefix(1);
            b.remove_prefix(1);
            continue;
        }
        const auto digits = [](std::string_view& text) {
            const auto end = std::ranges::find_if_not(text, is_digit);
            const std::string_view number =
                text.substr(0, static_cast<std::size_t>(end - text.begin()));
            text.remove_prefix(number.size());
            return number;
        };
        const std::string_view first = digits(a);
        const std::string_view second = digits(b);
        if (first.size() != second.size()) return first.size() < second.size();
        if (first != second) return first < second;
    }
    return a.size() < b.size();
}

std::vector<NamedImage> wanted_layers(const Panel& panel, const MapsPanel& maps) {
    std::vector<NamedImage> all = read_exr_layers(maps.file).images;
    // The one without a name is the image itself, or a copy of another.
    std::erase_if(all, [](const NamedImage& layer) { return layer.name.empty(); });
    std::ranges::sort(all, is_before, &NamedImage::name);
    std::vector<std::string> names;
    for (const NamedImage& layer : all) names.push_back(layer.name);
    require_titles_of(panel, names);
    if (all.empty()) {
        fail_at(panel.place, "'" + maps.file.string() + "' has no layer with a name");
    }
    if (maps.layers.empty()) return all;
    std::vector<NamedImage> wanted;
    for (const Placed<std::string>& name : maps.layers) {
        const std::size_t n_before = wanted.size();
        std::ranges::copy_if(all, std::back_inserter(wanted), [&name](const NamedImage& layer) {
            return layer.name == name.value || layer.name.starts_with(name.value + ".");
        });
        if (wanted.size() == n_before) {
            fail_at(name.place, fmt::format("'{}' has no layer '{}'; known: {}", maps.file.string(),
                                            name.value, fmt::join(names, " ")));
        }
    }
    return wanted;
}

// Of a technique's layer, such as weighted.n4.connect2: the parts of its name.
struct PyramidName {
    std::string kind;
    std::string length;  // edges of a path
    std::string technique;
    bool operator==(const PyramidName&) const = default;
};

std::optional<PyramidName> pyramid_name(const std::string& layer) {
    const std::size_t n = layer.find(".n");
    const std::size_t last = layer.rfind('.');
    if (n == std::string::npos || last <= n + 2) return std::nullopt;
    return PyramidName{layer.substr(0, n), layer.substr(n + 2, last - n - 2),
                       layer.substr(last + 1)};
}

struct LayerRow {
    std::string heading = {};  // above it
    std::string title = {};    // at its side
    std::vector<std::string> columns = {};
    std::vector<NamedImage> layers = {};
};

std::vector<LayerRow> in_rows(std::vector<NamedImage> layers, const Panel& panel, int columns) {
    std::vector<LayerRow> rows;
    std::optional<PyramidName> last;
    for (NamedImage& layer : layers) {
        const auto name = columns > 0 ? std::nullopt : pyramid_name(layer.name);
        const bool is_full =
            columns > 0
                ? !rows.empty() && std::ssize(rows.back().layers) == columns
                : name && (!last || name->kind != last->kind || name->length != last->length);
        if (rows.empty() || is_full) {
            LayerRow& row = rows.emplace_back();
            if (name) row.title = "n = " + name->length;
            if (name && (!last || name->kind != last->kind)) row.heading = name->kind;
        }
        const bool has_title = panel.titles.contains(layer.name);
        rows.back().columns.push_back(name && !has_title ? name->technique
                                                         : panel.title_of(layer.name));
        rows.back().layers.push_back(std::move(layer));
        last = name;
    }
    return rows;
}

ValueMap mean_of_channels(const Image& image) {
    ValueMap map{image.width, image.height, {}};
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
        const double sum =
            double{image.rgb[i]} + double{image.rgb[i + 1]} + double{image.rgb[i + 2]};
        map.values.push_back(sum / 3);
    }
    return map;
}

}  // namespace

double draw_layers(Drawing& drawing, const Style& style, const Panel& panel, double top) {
    const auto& maps = std::get<MapsPanel>(panel.kind);
    const std::vector<NamedImage> layers = wanted_layers(panel, maps);
    std::optional<ColourScale> scale;
    if (maps.false_colours && maps.range) {
        scale = ColourScale{(*maps.range)[0], (*maps.range)[1], maps.logarithmic};
    } else if (maps.false_colours) {
        std::vector<ValueMap> values;
        for (const NamedImage& layer : layers) values.push_back(mean_of_channels(layer.image));
        std::vector<const ValueMap*> pointers;
        for (const ValueMap& map : values) pointers.push_back(&map);
        scale = scale_of(pointers, maps.logarithmic);
    }
    const std::vector<LayerRow> rows = in_rows(layers, panel, maps.columns);
    std::size_t n_columns = 0;
    for (const LayerRow& row : rows) n_columns = std::max(n_columns, row.layers.size());
    double y = top + draw_title(drawing, style, panel.title, top);
    for (const LayerRow& row : rows) {
        if (!row.heading.empty()) {
            add_fitting(drawing, style,
                        {.at = {0, y + style.font_size},
                         .text = row.heading,
                         .size = style.font_size,
                         .bold = true},
                        style.width);
            y += style.line_height();
        }
        const Image& first = row.layers.front().image;
        GridRow images{.aspect = static_cast<double>(first.width) / first.height, .cells = {}};
        for (const NamedImage& layer : row.layers) {
            images.cells.push_back({.raster = scale
                                                  ? to_raster(mean_of_channels(layer.image), *scale)
                                                  : to_raster(layer.image, maps.exposure),
                                    .description = layer.name});
        }
        Grid grid{.columns = row.columns, .blocks = {{.title = row.title, .rows = {images}}}};
        if (scale && &row == &rows.back()) grid.bar = ColourBar{*scale, ""};
        y += draw_grid(drawing, style, grid, y, n_columns) + kRowGap;
    }
    return y - kRowGap - top;
}

}  // namespace misbench::figure
