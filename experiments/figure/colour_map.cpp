// [Ott20]  B. Ottosson, A perceptual color space for image processing, 2020 (Oklab).
// [OI08]   M. Okabe, K. Ito, Color Universal Design, 2008.
#include "experiments/figure/colour_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "renderer/base/check.h"
#include "renderer/image/srgb.h"

namespace misbench::figure {
namespace {

struct Linear {
    double red, green, blue;
    bool in_gamut() const {
        return std::min({red, green, blue}) >= 0 && std::max({red, green, blue}) <= 1;
    }
};

// The inverse matrices of [Ott20].
Linear from_oklab(double lightness, double a, double b) {
    const auto cube = [](double x) { return x * x * x; };
    const double l = cube(lightness + 0.3963377774 * a + 0.2158037573 * b);
    const double m = cube(lightness - 0.1055613458 * a - 0.0638541728 * b);
    const double s = cube(lightness - 0.0894841775 * a - 1.2914855480 * b);
    return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
            -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
            -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

struct Stop {
    double position;
    double hue;  // degrees in Oklab's a-b plane
    double chroma;
};
constexpr std::array kStops{Stop{0.00, -75, 0.03}, Stop{0.25, -55, 0.16}, Stop{0.50, 10, 0.20},
                            Stop{0.75, 55, 0.18}, Stop{1.00, 108, 0.10}};
constexpr double kDarkest = 0.08;
constexpr double kLightest = 0.97;

Stop stop_at(double position) {
    std::size_t i = 1;
    while (i + 1 < kStops.size() && position > kStops[i].position) ++i;
    const Stop& from = kStops[i - 1];
    const Stop& to = kStops[i];
    const double t = (position - from.position) / (to.position - from.position);
    return {position, std::lerp(from.hue, to.hue, t), std::lerp(from.chroma, to.chroma, t)};
}

double encoded(double linear) {
    return double{encode_srgb(static_cast<float>(std::clamp(linear, 0.0, 1.0)))};
}

}  // namespace

Colour false_colour(double position) {
    MISBENCH_CHECK(position >= 0 && position <= 1);
    const double lightness = std::lerp(kDarkest, kLightest, position);
    const Stop stop = stop_at(position);
    const double hue = stop.hue * std::numbers::pi / 180;
    // Less chroma where sRGB has no such colour: the lightness stays.
    double chroma = stop.chroma;
    Linear linear = from_oklab(lightness, chroma * std::cos(hue), chroma * std::sin(hue));
    while (!linear.in_gamut() && chroma > 1e-4) {
        chroma *= 0.97;
        linear = from_oklab(lightness, chroma * std::cos(hue), chroma * std::sin(hue));
    }
    return {encoded(linear.red), encoded(linear.green), encoded(linear.blue)};
}

// The colours of [OI08] but black and yellow, which is hard to see on paper.
Colour series_colour(std::size_t index) {
    constexpr std::array kColours{Colour{0.00, 0.45, 0.70}, Colour{0.84, 0.37, 0.00},
                                  Colour{0.00, 0.62, 0.45}, Colour{0.80, 0.47, 0.65},
                                  Colour{0.90, 0.62, 0.00}, Colour{0.34, 0.71, 0.91}};
    const Colour colour = kColours[index % kColours.size()];
    if (index / kColours.size() % 2 == 0) return colour;
    return {0.5 * (1 + colour.red), 0.5 * (1 + colour.green), 0.5 * (1 + colour.blue)};
}

}  // namespace misbench::figure
