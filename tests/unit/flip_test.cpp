#include "results/metrics/flip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "results/metrics/flip_color.h"
#include "results/metrics/flip_filters.h"

namespace misbench {
namespace {

constexpr double kPi = std::numbers::pi;

Image filled(int width, int height, float red, float green, float blue) {
    Image image(width, height);
    for (std::size_t p = 0; p < image.n_pixels(); ++p) {
        image.rgb[3 * p] = red;
        image.rgb[3 * p + 1] = green;
        image.rgb[3 * p + 2] = blue;
    }
    return image;
}

Image noise(int width, int height, unsigned seed) {
    Image image(width, height);
    std::mt19937 random(seed);
    std::gamma_distribution<float> gamma(2.0F, 0.2F);
    for (float& value : image.rgb) value = gamma(random);
    return image;
}

double mean_of(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

// --- FLIP once more, slowly: in double, with whole filters of two dimensions
// ----------------------

using Color = std::array<double, 3>;
using Pixels = std::vector<Color>;

// IEC 61966-2-1 with more digits.
Color to_xyz(const Color& c) {
    return {0.41238656 * c[0] + 0.35759149 * c[1] + 0.18045049 * c[2],
            0.21263682 * c[0] + 0.71518298 * c[1] + 0.07218020 * c[2],
            0.01933062 * c[0] + 0.11919716 * c[1] + 0.95037259 * c[2]};
}

// By Cramer's rule.
Color to_rgb(const Color& xyz) {
    const Color columns[3] = {to_xyz({1, 0, 0}), to_xyz({0, 1, 0}), to_xyz({0, 0, 1})};
    const auto determinant = [](const Color& a, const Color& b, const Color& c) {
        return a[0] * (b[1] * c[2] - b[2] * c[1]) - b[0] * (a[1] * c[2] - a[2] * c[1]) +
               c[0] * (a[1] * b[2] - a[2] * b[1]);
    };
    const double all = determinant(columns[0], columns[1], columns[2]);
    return {determinant(xyz, columns[1], columns[2]) / all,
            determinant(columns[0], xyz, columns[2]) / all,
            determinant(columns[0], columns[1], xyz) / all};
}

const Color kWhite = to_xyz({1, 1, 1});

Color to_lab(const Color& rgb) {
    Color f = to_xyz(rgb);
    for (std::size_t c = 0; c < 3; ++c) {
        const double t = f[c] / kWhite[c];
        f[c] = t > std::pow(6.0 / 29, 3) ? std::cbrt(t) : t * 841.0 / 108 + 4.0 / 29;
    }
    const double lightness = 116 * f[1] - 16;
    return {lightness, 0.01 * lightness * 500 * (f[0] - f[1]),
            0.01 * lightness * 200 * (f[1] - f[2])};
}

double distance(const Color& a, const Color& b) {
    return std::pow(std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]), 0.7);
}

struct SlowImage {
    int width, height;
    Pixels pixels;
    const Color& at(int x, int y) const {
        return pixels[static_cast<std::size_t>(std::clamp(y, 0, height - 1) * width +
                                               std::clamp(x, 0, width - 1))];
    }
};

template <typename Kernel>
double convolve(const SlowImage& image, std::size_t channel, int x, int y, int radius,
                const Kernel& kernel) {
    double positive = 0;
    double negative = 0;
    double sum_positive = 0;
    double sum_negative = 0;
    for (int dy = -radius; dy <= radius; ++dy) {
        for (int dx = -radius; dx <= radius; ++dx) {
            const double w = kernel(dx, dy);
            (w > 0 ? sum_positive : sum_negative) += w * image.at(x + dx, y + dy)[channel];
            (w > 0 ? positive : negative) += std::abs(w);
        }
    }
    return sum_positive / positive + (negative > 0 ? sum_negative / negative : 0);
}

double sensitivity(std::size_t channel, int dx, int dy) {
    const double d2 = (dx * dx + dy * dy) / (67.0 * 67.0);
    const auto term = [d2](double a, double b) {
        return a * std::sqrt(kPi / b) * std::exp(-kPi * kPi * d2 / b);
    };
    if (channel == 0) return term(1, 0.0047);
    if (channel == 1) return term(1, 0.0053);
    return term(34.1, 0.04) + term(13.5, 0.025);
}

SlowImage opponent(const Image& image, double (*tone)(double)) {
    SlowImage result{image.width, image.height, {}};
    for (std::size_t p = 0; p < image.n_pixels(); ++p) {
        Color rgb{};
        for (std::size_t c = 0; c < 3; ++c) {
            rgb[c] = tone(static_cast<double>(image.rgb[3 * p + c]));
        }
        Color xyz = to_xyz(rgb);
        for (std::size_t c = 0; c < 3; ++c) xyz[c] /= kWhite[c];
        result.pixels.push_back(
            {116 * xyz[1] - 16, 500 * (xyz[0] - xyz[1]), 200 * (xyz[1] - xyz[2])});
    }
    return result;
}

Color seen(const SlowImage& image, int x, int y) {
    Color f{};
    for (std::size_t c = 0; c < 3; ++c) {
        f[c] = convolve(image, c, x, y, 10, [c](int dx, int dy) { return sensitivity(c, dx, dy); });
    }
    const double grey = (f[0] + 16) / 116;
    const Color xyz{(grey + f[1] / 500) * kWhite[0], grey, (grey - f[2] / 200) * kWhite[2]};
    Color rgb = to_rgb(xyz);
    for (double& value : rgb) value = std::clamp(value, 0.0, 1.0);
    return to_lab(rgb);
}

// Length of the responses along x and y of a detector along x.
template <typename Detector>
double feature(const SlowImage& image, int x, int y, const Detector& detector) {
    return std::hypot(
               convolve(image, 0, x, y, 9, detector),
               convolve(image, 0, x, y, 9, [&](int dx, int dy) { return detector(dy, dx); })) /
           116;
}

std::vector<double> slow_flip(const Image& image, const Image& reference, double (*tone)(double)) {
    const double deviation = 0.5 * 0.082 * 67;
    const auto gauss = [=](int dx, int dy) {
        return std::exp(-(dx * dx + dy * dy) / (2 * deviation * deviation));
    };
    const auto edge = [=](int dx, int dy) { return -dx * gauss(dx, dy); };
    const auto point = [=](int dx, int dy) {
        return (dx * dx / (deviation * deviation) - 1) * gauss(dx, dy);
    };
    const double largest = distance(to_lab({0, 1, 0}), to_lab({0, 0, 1}));
    const SlowImage a = opponent(image, tone);
    const SlowImage b = opponent(reference, tone);
    std::vector<double> flip;
    for (int y = 0; y < a.height; ++y) {
        for (int x = 0; x < a.width; ++x) {
            const double d = distance(seen(a, x, y), seen(b, x, y));
            const double color = d < 0.4 * largest
                                     ? 0.95 * d / (0.4 * largest)
                                     : 0.95 + 0.05 * (d - 0.4 * largest) / (0.6 * largest);
            const double features =
                std::max(std::abs(feature(a, x, y, edge) - feature(b, x, y, edge)),
                         std::abs(feature(a, x, y, point) - feature(b, x, y, point)));
            flip.push_back(std::pow(color, 1 - std::sqrt(features / std::sqrt(2.0))));
        }
    }
    return flip;
}

double clamped(double light) { return std::clamp(light, 0.0, 1.0); }

void expect_same(const std::vector<double>& fast, const std::vector<double>& slow) {
    ASSERT_EQ(fast.size(), slow.size());
    for (std::size_t p = 0; p < fast.size(); ++p) {
        EXPECT_NEAR(fast[p], slow[p], 2e-4) << "pixel " << p;
    }
    EXPECT_NEAR(mean_of(fast), mean_of(slow), 1e-5);
}

// --- colours and filters -------------------------------------------------------------------------

TEST(FlipColor, HasThePublishedValuesOfThePrimaries) {
    const auto lab = [](const FlipColor& rgb) { return lab_from_xyz(xyz_from_linear_rgb(rgb)); };
    const auto expect = [](const FlipColor& found, double l, double a, double b) {
        EXPECT_NEAR(static_cast<double>(found[0]), l, 0.02);
        EXPECT_NEAR(static_cast<double>(found[1]), a, 0.02);
        EXPECT_NEAR(static_cast<double>(found[2]), b, 0.02);
    };
    // CIE 1976 L*a*b* of sRGB's primaries under D65.
    expect(lab({1, 0, 0}), 53.24, 80.09, 67.20);
    expect(lab({0, 1, 0}), 87.73, -86.18, 83.18);
    expect(lab({0, 0, 1}), 32.30, 79.19, -107.86);
    expect(lab({1, 1, 1}), 100, 0, 0);
    expect(lab({0, 0, 0}), 0, 0, 0);
    expect(ycxcz_from_xyz(xyz_from_linear_rgb({1, 1, 1})), 100, 0, 0);
    expect(ycxcz_from_xyz(xyz_from_linear_rgb({0, 0, 0})), -16, 0, 0);
    expect(hunt_adjusted({50, 20, -10}), 50, 10, -5);
    EXPECT_FLOAT_EQ(hyab({50, 3, 0}, {40, 0, 4}), 15);
}

TEST(FlipColor, ComesBackFromEverySpace) {
    for (const FlipColor& rgb :
         {FlipColor{0.2F, 0.5F, 0.9F}, FlipColor{0, 0, 0}, FlipColor{1, 0, 0.5F}}) {
        const FlipColor back =
            linear_rgb_from_xyz(xyz_from_ycxcz(ycxcz_from_xyz(xyz_from_linear_rgb(rgb))));
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(back[c], rgb[c], 1e-6F);
    }
}

TEST(FlipFilters, OfContrastSumToOneAndAreSymmetric) {
    const ContrastFilters filters = contrast_filters(67);
    for (const auto& parts : filters.parts) {
        double volume = 0;
        for (const auto& [share, weights] : parts) {
            EXPECT_EQ(weights.size(), 21U);
            double sum = 0;
            for (const float w : weights) sum += static_cast<double>(w);
            volume += share * sum * sum;
            for (std::size_t i = 0; i < weights.size(); ++i) {
                EXPECT_EQ(weights[i], weights[weights.size() - 1 - i]);
            }
        }
        EXPECT_NEAR(volume, 1, 1e-6);
    }
}

TEST(FlipFilters, OfFeaturesAnswerToAStepOrALineWithOneAndToNothingWithNothing) {
    Plane flat(40, 30);
    std::ranges::fill(flat.values, 0.7F);
    Plane step(40, 30);
    for (std::size_t i = 0; i < step.values.size(); ++i) step.values[i] = i % 40 < 20 ? 0.0F : 1.0F;
    const FeatureFilters filters = feature_filters(67);
    for (const float edge : find_features(flat, filters).edges.values) EXPECT_NEAR(edge, 0, 1e-6F);
    for (const float point : find_features(flat, filters).points.values) {
        EXPECT_NEAR(point, 0, 1e-6F);
    }
    // The derivative is odd: a step at a pixel's border misses nothing but the middle weight, 0.
    EXPECT_NEAR(find_features(step, filters).edges.values[15 * 40 + 20], 1, 1e-5F);
    EXPECT_NEAR(find_features(step, filters).edges.values[15 * 40], 0, 1e-5F);
}

TEST(FlipFilters, GoOnWithTheNearestPixelOutOfTheImage) {
    Plane plane(3, 2);
    plane.values = {1, 2, 4, 8, 16, 32};
    const FilterWeights weights{0.5F, 0, 0, 0, 0.25F};
    EXPECT_EQ(filter_rows(plane, weights).values,
              (std::vector<float>{1.5F, 1.5F, 1.5F, 12, 12, 12}));
    EXPECT_EQ(filter_columns(plane, weights).values,
              (std::vector<float>{2.5F, 5, 10, 2.5F, 5, 10}));
}

// --- the whole -----------------------------------------------------------------------------------

TEST(Flip, IsWhatItsSlowFormSays) {
    for (const auto& [width, height] : {std::pair(37, 23), std::pair(8, 5), std::pair(1, 30)}) {
        const Image image = noise(width, height, 1);
        const Image reference = noise(width, height, 2);
        expect_same(ldr_flip(image, reference), slow_flip(image, reference, clamped));
    }
    // Against a smooth one, and with colour that only some channels show.
    Image ramp(29, 31);
    for (std::size_t i = 0; i < ramp.rgb.size(); ++i) {
        ramp.rgb[i] = static_cast<float>(i) / static_cast<float>(ramp.rgb.size());
    }
    const Image blue = filled(29, 31, 0.1F, 0.1F, 0.8F);
    expect_same(ldr_flip(blue, ramp), slow_flip(blue, ramp, clamped));
}

TEST(Flip, OfHighDynamicRangeIsTheLargestOverItsExposures) {
    const Image image = noise(23, 17, 3);
    Image reference = noise(23, 17, 4);
    for (float& value : reference.rgb) value = std::pow(value, 3.0F);
    const auto exposures = flip_exposures(reference);
    ASSERT_GT(exposures.size(), 2U);
    std::vector<double> slow(image.n_pixels(), 0.0);
    const auto exposed = [](const Image& original, double exposure) {
        Image result = original;
        for (float& value : result.rgb) {
            const double x = 0.6 * std::exp2(exposure) * static_cast<double>(value);
            value = static_cast<float>(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14));
        }
        return result;
    };
    for (const double exposure : exposures) {
        const auto flip =
            slow_flip(exposed(image, exposure), exposed(reference, exposure), clamped);
        for (std::size_t p = 0; p < slow.size(); ++p) slow[p] = std::max(slow[p], flip[p]);
    }
    expect_same(hdr_flip(image, reference), slow);
}

TEST(Flip, ExposuresGoFromTheLightestPixelOfTheReferenceToItsMedian) {
    // Five pixels, of luminance 8 at most and 1 in the middle.
    Image reference(5, 1);
    const float light[] = {0.25F, 8, 1, 0.5F, 2};
    for (std::size_t i = 0; i < reference.rgb.size(); ++i) reference.rgb[i] = light[i / 3];
    const auto exposures = flip_exposures(reference);
    ASSERT_EQ(exposures.size(), 3U);
    EXPECT_NEAR(tone_mapped(8 * std::exp2(exposures.front())), 0.85, 1e-7);
    EXPECT_NEAR(tone_mapped(1 * std::exp2(exposures.back())), 0.85, 1e-7);
    EXPECT_NEAR(exposures[1], 0.5 * (exposures[0] + exposures[2]), 1e-12);
    // One tone needs one exposure.
    EXPECT_EQ(flip_exposures(filled(4, 4, 3, 3, 3)).size(), 1U);
    EXPECT_EQ(flip_exposures(filled(4, 4, 0, 0, 0)).size(), 1U);
}

TEST(Flip, OfTheSameImageIsNothingAndDoesNotDependOnTheOrder) {
    const Image a = noise(31, 22, 5);
    const Image b = noise(31, 22, 6);
    for (const double value : ldr_flip(a, a)) EXPECT_EQ(value, 0);
    for (const double value : hdr_flip(a, a)) EXPECT_EQ(value, 0);
    EXPECT_EQ(ldr_flip(a, b), ldr_flip(b, a));  // only the exposures know which is which
}

TEST(Flip, OfConstantImagesHasAClosedForm) {
    // No edges, no points, and a filter leaves a constant as it is.
    const auto flip =
        ldr_flip(filled(25, 25, 0.25F, 0.25F, 0.25F), filled(25, 25, 0.5F, 0.5F, 0.5F));
    const double difference = std::pow(116 * (std::cbrt(0.5) - std::cbrt(0.25)), 0.7);
    const double largest = distance(to_lab({0, 1, 0}), to_lab({0, 0, 1}));
    for (const double value : flip) {
        EXPECT_NEAR(value, 0.95 * difference / (0.4 * largest), 1e-4);
    }
    // The two colours that are farthest apart.
    EXPECT_NEAR(mean_of(ldr_flip(filled(9, 9, 0, 1, 0), filled(9, 9, 0, 0, 1))), 1, 1e-3);
}

TEST(Flip, StaysInItsRangeForEveryExtreme) {
    Image firefly = noise(21, 13, 7);
    firefly.rgb[300] = 1e12F;
    Image negative = noise(21, 13, 8);
    for (float& value : negative.rgb) value = -value;
    const std::vector<Image> extremes{
        filled(21, 13, 0, 0, 0),         noise(21, 13, 9), firefly,
        filled(21, 13, 1e-9F, 1e-9F, 0), negative,         filled(21, 13, 3e38F, 3e38F, 3e38F)};
    for (const Image& image : extremes) {
        for (const Image& reference : extremes) {
            for (const auto& flip : {ldr_flip(image, reference), hdr_flip(image, reference)}) {
                for (const double value : flip) {
                    ASSERT_GE(value, 0);
                    ASSERT_LE(value, 1);
                }
            }
        }
    }
    // Less light than none is none.
    EXPECT_EQ(mean_of(hdr_flip(negative, extremes[0])), 0);
    // One pixel is all there is, far smaller than a filter.
    EXPECT_GT(ldr_flip(filled(1, 1, 1, 1, 1), filled(1, 1, 0, 0, 0))[0], 0.9);
    // A firefly is seen where it is, and nowhere far away.
    const Image still = noise(60, 60, 10);
    Image flash = still;
    for (std::size_t c = 0; c < 3; ++c) flash.rgb[3 * (30 * 60 + 30) + c] = 1e12F;
    const auto flip = hdr_flip(flash, still);
    EXPECT_EQ(std::ranges::max_element(flip) - flip.begin(), 30 * 60 + 30);
    EXPECT_GT(flip[30 * 60 + 30], 0.2);
    EXPECT_EQ(flip[0], 0);
}

}  // namespace
}  // namespace misbench
