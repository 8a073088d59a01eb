#include "results/metrics/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "results/metrics/flip_color.h"
#include "results/metrics/flip_filters.h"
#include "results/metrics/luminance.h"

namespace misbench {
namespace {

// The constants of [And20].
constexpr float kColorExponent = 0.7F;    // q_c
constexpr float kKnee = 0.4F;             // p_c: the part of the largest difference …
constexpr float kKneeValue = 0.95F;       // p_t: … that is mapped up to this value
constexpr float kFeatureExponent = 0.5F;  // q_f

// (k0 x² + k1 x + k2) / (k3 x² + k4 x + k5), with x before the curve's own exposure of 0.6. [And21]
constexpr std::array<double, 6> kAces{0.6 * 0.6 * 2.51, 0.6 * 0.03, 0.0,
                                      0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14};
// The tone that the lightest pixel has at the first exposure, the median one at the last. [And21]
constexpr double kExposedTone = 0.85;
// Light below it counts as it, so that black has an exposure: the 2^-23 of FLIP's own tool.
constexpr double kLeastLight = 0x1p-23;

// Which light shows which tone on the display, in [0, 1].
struct Clamped {
    double operator()(double light) const { return std::clamp(light, 0.0, 1.0); }
};
struct Exposed {
    double scale;
    double operator()(double light) const { return tone_mapped(scale * light); }
};

// What the eye makes of an image: colours as far as they are resolved, edges and points.
struct Percept {
    std::array<Plane, 3> filtered;  // YCxCz
    Features features;
};

struct Filters {
    ContrastFilters contrast = contrast_filters(kFlipPixelsPerDegree);
    FeatureFilters features = feature_filters(kFlipPixelsPerDegree);
};

template <typename Tone>
Percept perceive(const Image& image, const Tone& tone, const Filters& filters) {
    const Plane blank(image.width, image.height);
    std::array<Plane, 3> ycxcz{blank, blank, blank};
    Plane grey = blank;
    for (std::size_t p = 0; p < grey.values.size(); ++p) {
        FlipColor rgb{};
        for (std::size_t c = 0; c < 3; ++c) {
            rgb[c] = static_cast<float>(tone(static_cast<double>(image.rgb[3 * p + c])));
        }
        const FlipColor xyz = xyz_from_linear_rgb(rgb);
        const FlipColor color = ycxcz_from_xyz(xyz);
        for (std::size_t c = 0; c < 3; ++c) ycxcz[c].values[p] = color[c];
        grey.values[p] = xyz[1];
    }
    return {.filtered = {filter_contrast(ycxcz[0], filters.contrast.parts[0]),
                         filter_contrast(ycxcz[1], filters.contrast.parts[1]),
                         filter_contrast(ycxcz[2], filters.contrast.parts[2])},
            .features = find_features(grey, filters.features)};
}

FlipColor hunt_lab_of_rgb(const FlipColor& rgb) {
    return hunt_adjusted(lab_from_xyz(xyz_from_linear_rgb(rgb)));
}

// The filtered colour, brought back into the display's gamut.
FlipColor seen_color(const std::array<Plane, 3>& ycxcz, std::size_t p) {
    FlipColor rgb = linear_rgb_from_xyz(
        xyz_from_ycxcz({ycxcz[0].values[p], ycxcz[1].values[p], ycxcz[2].values[p]}));
    for (float& value : rgb) value = std::clamp(value, 0.0F, 1.0F);
    return hunt_lab_of_rgb(rgb);
}

// ΔE_c in [0, 1]: the distance of two colours to the power q_c, the part of it that matters most
// stretched over most of the interval.                                                    [And20]
float color_difference(const FlipColor& a, const FlipColor& b) {
    static const float largest =
        std::pow(hyab(hunt_lab_of_rgb({0, 1, 0}), hunt_lab_of_rgb({0, 0, 1})), kColorExponent);
    const float distance = std::pow(hyab(a, b), kColorExponent);
    const float knee = kKnee * largest;
    if (distance < knee) return kKneeValue / knee * distance;
    return kKneeValue + (distance - knee) / (largest - knee) * (1.0F - kKneeValue);
}

// ΔE_f in [0, 1].                                                                         [And20]
float feature_difference(const Features& a, const Features& b, std::size_t p) {
    const float edge = std::abs(a.edges.values[p] - b.edges.values[p]);
    const float point = std::abs(a.points.values[p] - b.points.values[p]);
    return std::pow(std::max(edge, point) / std::numbers::sqrt2_v<float>, kFeatureExponent);
}

template <typename Tone>
std::vector<double> flip_of(const Image& image, const Image& reference, const Tone& tone) {
    static const Filters filters;
    const Percept a = perceive(image, tone, filters);
    const Percept b = perceive(reference, tone, filters);
    std::vector<double> flip(image.n_pixels());
    for (std::size_t p = 0; p < flip.size(); ++p) {
        const float color = color_difference(seen_color(a.filtered, p), seen_color(b.filtered, p));
        const float feature = feature_difference(a.features, b.features, p);
        flip[p] = static_cast<double>(std::pow(color, 1.0F - feature));
    }
    return flip;
}

// The light that is shown with the tone `tone`.
double light_of_tone(double tone) {
    const double a = kAces[0] - tone * kAces[3];
    const double b = kAces[1] - tone * kAces[4];
    const double c = kAces[2] - tone * kAces[5];
    return (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
}

}  // namespace

double tone_mapped(double light) {
    const double x = std::max(light, 0.0);
    const auto& k = kAces;
    return std::min((x * (k[0] * x + k[1]) + k[2]) / (x * (k[3] * x + k[4]) + k[5]), 1.0);
}

std::vector<double> flip_exposures(const Image& reference) {
    std::vector<double> light = luminances(reference);
    const auto median = light.begin() + static_cast<std::ptrdiff_t>(light.size() / 2);
    std::nth_element(light.begin(), median, light.end());
    const double median_light = std::max(*median, kLeastLight);
    const double largest_light = std::max(*std::max_element(median, light.end()), kLeastLight);
    const double shown = light_of_tone(kExposedTone);
    const double start = std::log2(shown / largest_light);
    const double stop = std::log2(shown / median_light);
    if (start == stop) return {start};
    const int n = std::max(2, static_cast<int>(std::ceil(stop - start)));
    std::vector<double> exposures;
    for (int i = 0; i < n; ++i) exposures.push_back(start + i * (stop - start) / (n - 1));
    return exposures;
}

std::vector<double> ldr_flip(const Image& image, const Image& reference) {
    return flip_of(image, reference, Clamped{});
}

std::vector<double> hdr_flip(const Image& image, const Image& reference) {
    std::vector<double> largest(image.n_pixels(), 0.0);
    for (const double exposure : flip_exposures(reference)) {
        const std::vector<double> flip = flip_of(image, reference, Exposed{std::exp2(exposure)});
        for (std::size_t p = 0; p < largest.size(); ++p) largest[p] = std::max(largest[p], flip[p]);
    }
    return largest;
}

}  // namespace misbench
