#include "experiments/figure/raster.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "experiments/figure/colour_map.h"
#include "renderer/base/check.h"

namespace misbench::figure {
namespace {

constexpr double kLowShare = 0.01;  // of the values, below the scale
constexpr double kHighShare = 0.99;

// 0.034 becomes 0.03 or 0.04.
double to_one_digit(double value, bool up) {
    const double unit = std::pow(10.0, std::floor(std::log10(value)));
    return unit * (up ? std::ceil(value / unit - 1e-9) : std::floor(value / unit + 1e-9));
}

}  // namespace

double ColourScale::position(double value) const {
    if (logarithmic && !(value > 0)) return 0;
    const double t =
        logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
    return t > 0 ? std::min(t, 1.0) : 0.0;
}

Raster to_raster(const Image& image, double exposure) {
    return {image.width, image.height, to_srgb_bytes(image, exposure)};
}

Raster to_raster(const ValueMap& map, const ColourScale& scale) {
    // Colours cost more to compute than to look up.
    constexpr std::size_t kColours = 1024;
    static const auto table = [] {
        std::array<std::array<std::uint8_t, 3>, kColours> colours{};
        for (std::size_t i = 0; i < kColours; ++i) {
            const Colour c = false_colour(static_cast<double>(i) / (kColours - 1));
            const auto byte = [](double x) {
                return static_cast<std::uint8_t>(std::lround(255 * x));
            };
            colours[i] = {byte(c.red), byte(c.green), byte(c.blue)};
        }
        return colours;
    }();
    Raster raster{map.width, map.height, {}};
    raster.rgb.reserve(3 * map.values.size());
    for (const double value : map.values) {
        const auto index =
            static_cast<std::size_t>(std::lround(scale.position(value) * (kColours - 1)));
        raster.rgb.insert(raster.rgb.end(), table[index].begin(), table[index].end());
    }
    return raster;
}

Raster cut(const Raster& raster, const Window& window) {
    MISBENCH_CHECK(window.x >= 0 && window.y >= 0 && window.x + window.width <= raster.width &&
                   window.y + window.height <= raster.height);
    Raster part{window.width, window.height, {}};
    for (int y = window.y; y < window.y + window.height; ++y) {
        const auto row = raster.rgb.begin() + 3 * (std::ptrdiff_t{y} * raster.width + window.x);
        part.rgb.insert(part.rgb.end(), row, row + 3 * std::ptrdiff_t{window.width});
    }
    return part;
}

Raster split(const Raster& left, const Raster& right) {
    MISBENCH_CHECK(left.width == right.width && left.height == right.height);
    Raster both = right;
    for (int y = 0; y < left.height; ++y) {
        const auto offset = 3 * std::ptrdiff_t{y} * left.width;
        std::copy_n(left.rgb.begin() + offset, 3 * (left.width / 2), both.rgb.begin() + offset);
    }
    return both;
}

double mean_within(const ValueMap& map, const Window& window) {
    double sum = 0;
    for (int y = window.y; y < window.y + window.height; ++y) {
        for (int x = window.x; x < window.x + window.width; ++x) sum += map.at(x, y);
    }
    return sum / (static_cast<double>(window.width) * window.height);
}

ColourScale scale_of(const std::vector<const ValueMap*>& maps, bool logarithmic) {
    std::vector<double> positive;
    for (const ValueMap* map : maps) {
        std::ranges::copy_if(map->values, std::back_inserter(positive),
                             [](double value) { return value > 0 && std::isfinite(value); });
    }
    if (positive.empty()) positive.push_back(1);
    std::ranges::sort(positive);
    const auto share = [&positive](double p) {
        return positive[static_cast<std::size_t>(p * static_cast<double>(positive.size() - 1))];
    };
    const double high = to_one_digit(share(kHighShare), true);
    if (!logarithmic) return {0, high, false};
    const double low = to_one_digit(share(kLowShare), false);
    return {low < high ? low : high / 10, high, true};
}

}  // namespace misbench::figure
