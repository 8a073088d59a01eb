// The layers of an EXR file: maps of factors and weights in false colours, techniques as images.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "experiments/figure/grid.h"
#include "experiments/figure/query.h"

namespace misbench::figure {
namespace {

std::vector<NamedImage> wanted_layers(const Panel& panel, const MapsPanel& maps) {
    std::vector<NamedImage> all = read_exr_layers(maps.file).images;
    // The one without a name is the image itself, or a copy of another.
    std::erase_if(all, [](const NamedImage& layer) { return layer.name.empty(); });
    std::vector<std::string> names;
    for (const NamedImage& layer : all) names.push_back(layer.name);
    require_titles_of(panel, names);
    if (maps.layers.empty()) return all;
    std::vector<NamedImage> wanted;
    for (const Placed<std::string>& name : maps.layers) {
        const auto found = std::ranges::find(all, name.value, &NamedImage::name);
        if (found == all.end()) {
            fail_at(name.place, fmt::format("'{}' has no layer '{}'; known: {}",
                                            maps.file.string(), name.value, fmt::join(names, " ")));
        }
        wanted.push_back(*found);
    }
    return wanted;
}

// "weighted.n4." of "weighted.n4.connect2": techniques of one row of the pyramid; "" for others.
std::string row_of(const std::string& layer) {
    const std::size_t first = layer.find(".n");
    const std::size_t last = layer.rfind('.');
    return first == std::string::npos || last <= first ? "" : layer.substr(0, last + 1);
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

std::vector<std::vector<NamedImage>> in_rows(std::vector<NamedImage> layers, int columns) {
    std::vector<std::vector<NamedImage>> rows;
    std::string row;
    for (NamedImage& layer : layers) {
        const std::string its_row = row_of(layer.name);
        const bool is_full = columns > 0
                                 ? !rows.empty() && static_cast<int>(rows.back().size()) == columns
                                 : its_row != row;
        if (rows.empty() || is_full) rows.emplace_back();
        row = its_row;
        rows.back().push_back(std::move(layer));
    }
    return rows;
}

}  // namespace

double draw_layers(Drawing& drawing, const Style& style, const Panel& panel, double top) {
    const auto& maps = std::get<MapsPanel>(panel.kind);
    const std::vector<NamedImage> layers = wanted_layers(panel, maps);
    if (layers.empty()) {
        fail_at(panel.place, "'" + maps.file.string() + "' has no layer with a name");
    }
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
    const auto rows = in_rows(layers, maps.columns);
    std::size_t n_columns = 0;
    for (const auto& row : rows) n_columns = std::max(n_columns, row.size());
    double y = top + draw_title(drawing, style, panel.title, top);
    for (const auto& row : rows) {
        Grid grid{.title = "", .columns = {}, .blocks = {{.title = ""}}, .bar = {}};
        GridRow images{.aspect = static_cast<double>(row[0].image.width) / row[0].image.height,
                       .cells = {}};
        for (const NamedImage& layer : row) {
            grid.columns.push_back(panel.title_of(layer.name));
            images.cells.push_back({.raster = scale
                                                  ? to_raster(mean_of_channels(layer.image), *scale)
                                                  : to_raster(layer.image, maps.exposure),
                                    .description = layer.name,
                                    .inset = {},
                                    .frame = {}});
        }
        grid.blocks[0].rows.push_back(std::move(images));
        if (scale && &row == &rows.back()) grid.bar = ColourBar{*scale, ""};
        y += draw_grid(drawing, style, grid, y, n_columns) + 3;
    }
    return y - 3 - top;
}

}  // namespace misbench::figure
