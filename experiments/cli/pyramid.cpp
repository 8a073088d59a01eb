#include "experiments/cli/pyramid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/cli/output.h"

namespace misbench {
namespace {

constexpr int kGap = 2;              // pixels between cells
constexpr double kGapGrey = 0.05;    // linear; so is the place of a technique without an image
constexpr int kMaxSheetSide = 4096;  // pixels

// Which cell of the pyramid an image has.
struct Layout {
    std::vector<int> rows;           // path lengths
    std::vector<Technique> columns;  // in the order of their indices in long paths

    explicit Layout(const std::vector<TechniqueImage>& techniques) {
        for (const TechniqueImage& image : techniques) {
            if (rows.empty() || rows.back() != image.n_edges) rows.push_back(image.n_edges);
            if (std::ranges::find(columns, image.technique) == columns.end()) {
                columns.push_back(image.technique);
            }
        }
        const int longest = rows.empty() ? 1 : rows.back();
        std::ranges::sort(columns, {}, [=](Technique t) { return t.index(longest); });
    }
    std::size_t row(const TechniqueImage& image) const {
        return static_cast<std::size_t>(std::ranges::find(rows, image.n_edges) - rows.begin());
    }
    std::size_t column(const TechniqueImage& image) const {
        return static_cast<std::size_t>(std::ranges::find(columns, image.technique) -
                                        columns.begin());
    }
};

double mean(const Image& image) {
    double sum = 0;
    for (const float value : image.rgb) sum += double{value};
    return sum / static_cast<double>(image.rgb.size());
}

// Copies the image into the sheet with its top left corner at (x0, y0), `shrink` pixels of a side
// into one: their mean, of those that the image has at its edges.
void paste(const Image& image, int shrink, int x0, int y0, Image& sheet) {
    for (int y = 0; y < image.height; y += shrink) {
        for (int x = 0; x < image.width; x += shrink) {
            const int x1 = std::min(x + shrink, image.width);
            const int y1 = std::min(y + shrink, image.height);
            double sum[3] = {};
            for (int v = y; v < y1; ++v) {
                for (int u = x; u < x1; ++u) {
                    const float* rgb =
                        &image.rgb[3 * static_cast<std::size_t>(v * image.width + u)];
                    for (int c = 0; c < 3; ++c) sum[c] += double{rgb[c]};
                }
            }
            float* rgb = &sheet.rgb[3 * static_cast<std::size_t>((y0 + y / shrink) * sheet.width +
                                                                 x0 + x / shrink)];
            for (int c = 0; c < 3; ++c) {
                rgb[c] = static_cast<float>(sum[c] / ((x1 - x) * (y1 - y)));
            }
        }
    }
}

}  // namespace

void write_pyramid_exr(const std::filesystem::path& path, const Image& image,
                       const std::vector<TechniqueImage>& techniques) {
    std::vector<ImageLayer> layers{{"", &image}};
    for (const TechniqueImage& technique : techniques) {
        layers.push_back({"weighted." + technique.name(), &technique.weighted});
        layers.push_back({"unweighted." + technique.name(), &technique.unweighted});
    }
    write_exr_layers(path, layers);
}

std::string pyramid_png(const std::vector<TechniqueImage>& techniques, double exposure) {
    const Layout layout(techniques);
    const auto n_columns = static_cast<int>(layout.columns.size());
    const auto n_rows = static_cast<int>(layout.rows.size());
    const Image& first = techniques.front().weighted;
    const int side = std::max(n_columns * first.width, 2 * n_rows * first.height);
    const int shrink = (side + kMaxSheetSide - 1) / kMaxSheetSide;
    const int cell_width = (first.width + shrink - 1) / shrink + kGap;
    const int cell_height = (first.height + shrink - 1) / shrink + kGap;
    Image sheet(n_columns * cell_width - kGap, 2 * n_rows * cell_height + kGap);
    std::ranges::fill(sheet.rgb, static_cast<float>(kGapGrey * std::exp2(-exposure)));
    for (const TechniqueImage& image : techniques) {
        const int x = static_cast<int>(layout.column(image)) * cell_width;
        const int y = static_cast<int>(layout.row(image)) * cell_height;
        paste(image.weighted, shrink, x, y, sheet);
        paste(image.unweighted, shrink, x, y + n_rows * cell_height + 2 * kGap, sheet);
    }
    return encode_png(sheet, exposure);
}

std::string pyramid_text(const Image& image, const std::vector<TechniqueImage>& techniques) {
    const Layout layout(techniques);
    const double all = mean(image);
    std::vector<std::vector<std::string>> table(layout.rows.size() + 1);
    table[0].emplace_back("% of image");
    for (const Technique column : layout.columns) table[0].push_back(technique_name(column));
    for (std::size_t row = 0; row < layout.rows.size(); ++row) {
        table[row + 1].assign(table[0].size(), "-");
        table[row + 1][0] = fmt::format("n = {}", layout.rows[row]);
    }
    for (const TechniqueImage& technique : techniques) {
        table[layout.row(technique) + 1][layout.column(technique) + 1] =
            fmt::format("{:.3g}", 100 * mean(technique.weighted) / all);
    }
    return align(table);
}

}  // namespace misbench
