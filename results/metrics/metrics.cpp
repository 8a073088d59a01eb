#include "results/metrics/metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>

#include "renderer/base/error.h"
#include "results/metrics/flip.h"
#include "results/metrics/luminance.h"

namespace misbench {
namespace {

// [Vog18] T. Vogels et al., Denoising with Kernel Prediction and Asymmetric Loss Functions, 2018.

// Keeps the relative error of black pixels finite.
constexpr double kEpsilon = 0.01;
// The same for the mean luminance of an image that is all black.
constexpr double kLuminanceEpsilon = 1e-9;
// Share of the pixels that the trimmed metric leaves out, and that the tail is.
constexpr double kTail = 0.001;

// A channel of a pixel.
struct Channel {
    double image, a, b;
    double reference() const { return 0.5 * (a + b); }
};

// Mean over the channels of `error`, for each pixel in order.
template <typename Error>
std::vector<double> pixel_errors(const Image& image, const ReferencePair& reference,
                                 const Error& error) {
    std::vector<double> errors(image.n_pixels());
    for (std::size_t p = 0; p < errors.size(); ++p) {
        double sum = 0;
        for (std::size_t i = 3 * p; i < 3 * p + 3; ++i) {
            sum += error(Channel{.image = static_cast<double>(image.rgb[i]),
                                 .a = static_cast<double>(reference.a.rgb[i]),
                                 .b = static_cast<double>(reference.b.rgb[i])});
        }
        errors[p] = sum / 3;
    }
    return errors;
}

// What squared errors are divided by. It carries the reference's noise, which correlates with the
// numerator's: a residue that falls with the reference's samples (simulated: +0.2 % at 64 times the
// samples of the image). Only fixed weights from a third reference would remove it.
double square_of(double reference) { return reference * reference + kEpsilon; }
// grittmann2019 section 6 divides by the reference, not by its square.
double value_of(double reference) { return reference + kEpsilon; }
double one(double) { return 1; }

template <double (*denominator)(double)>
std::vector<double> squared_errors(const Image& image, const ReferencePair& reference) {
    return pixel_errors(image, reference, [](const Channel& c) {
        return (c.image - c.a) * (c.image - c.b) / denominator(c.reference());
    });
}

double sum_of(std::span<const double> values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum;
}

double mean_of(const std::vector<double>& values) {
    return sum_of(values) / static_cast<double>(values.size());
}

// Mean of all but the k largest values.
double trimmed_mean(const std::vector<double>& values, std::size_t k) {
    std::vector<double> ordered = values;
    const auto first_dropped = ordered.end() - static_cast<std::ptrdiff_t>(k);
    std::nth_element(ordered.begin(), first_dropped, ordered.end());
    if (first_dropped == ordered.end()) return mean_of(values);
    const double limit = *first_dropped;
    // Of the values that equal the limit, so many stay that k go in all.
    auto n_equal_kept = std::count(ordered.begin(), first_dropped, limit);
    double sum = 0;
    for (const double value : values) {
        if (value < limit || (value == limit && n_equal_kept-- > 0)) sum += value;
    }
    return sum / static_cast<double>(values.size() - k);
}

template <double (*denominator)(double)>
double squared_error(const Image& image, const ReferencePair& reference) {
    return mean_of(squared_errors<denominator>(image, reference));
}

double relmse_trimmed(const Image& image, const ReferencePair& reference) {
    const auto errors = squared_errors<square_of>(image, reference);
    return trimmed_mean(errors,
                        static_cast<std::size_t>(kTail * static_cast<double>(errors.size())));
}

// Against R and so never negative: else a share could be more than the whole.
std::vector<double> naive_relative_errors(const Image& image, const ReferencePair& reference) {
    return pixel_errors(image, reference, [](const Channel& c) {
        const double difference = c.image - c.reference();
        return difference * difference / square_of(c.reference());
    });
}

double share_of_worst_pixels(const Image& image, const ReferencePair& reference) {
    std::vector<double> errors = naive_relative_errors(image, reference);
    const double all = sum_of(errors);
    if (all == 0) return 0;
    const auto n = static_cast<std::ptrdiff_t>(
        std::ceil(kTail * static_cast<double>(errors.size())));  // so at least one
    std::nth_element(errors.begin(), errors.end() - n, errors.end());
    return sum_of({errors.end() - n, errors.end()}) / all;
}

// Bounded, so a firefly counts no more than any wrong pixel.                               [Vog18]
std::vector<double> symmetric_errors(const Image& image, const ReferencePair& reference) {
    return pixel_errors(image, reference, [](const Channel& c) {
        return std::abs(c.image - c.reference()) /
               (std::abs(c.image) + std::abs(c.reference()) + kEpsilon);
    });
}

double smape(const Image& image, const ReferencePair& reference) {
    return mean_of(symmetric_errors(image, reference));
}

double mean(const Image& image, const ReferencePair&) {
    double sum = 0;
    for (const float value : image.rgb) sum += static_cast<double>(value);
    return sum / static_cast<double>(image.rgb.size());
}

double mean_luminance(const Image& image, const ReferencePair&) {
    return mean_of(luminances(image));
}

double bias_of_mean_luminance(const Image& image, const ReferencePair& reference) {
    const double expected =
        0.5 * (mean_of(luminances(reference.a)) + mean_of(luminances(reference.b)));
    return (mean_of(luminances(image)) - expected) / (expected + kLuminanceEpsilon);
}

Image mean_of_halves(const ReferencePair& reference) {
    Image mean = reference.a;
    for (std::size_t i = 0; i < mean.rgb.size(); ++i) {
        mean.rgb[i] = 0.5F * reference.a.rgb[i] + 0.5F * reference.b.rgb[i];
    }
    return mean;
}

std::vector<double> ldr_flip_map(const Image& image, const ReferencePair& reference) {
    return ldr_flip(image, mean_of_halves(reference));
}

double mean_ldr_flip(const Image& image, const ReferencePair& reference) {
    return mean_of(ldr_flip_map(image, reference));
}

std::vector<double> hdr_flip_map(const Image& image, const ReferencePair& reference) {
    return hdr_flip(image, mean_of_halves(reference));
}

double mean_hdr_flip(const Image& image, const ReferencePair& reference) {
    return mean_of(hdr_flip_map(image, reference));
}

static_assert(kFlipPixelsPerDegree == 67, "a metric's id names it");

constexpr auto kRatios = AcrossScenes::GeometricMeanOfRatios;
constexpr auto kNothing = AcrossScenes::Nothing;

// To add a metric: write its function above, add its row here. An id is never used again for
// another number; what changes a number changes the id.
constexpr std::array kMetrics{
    Metric{"relmse.eps0.01", "mean of (I-r1)(I-r2) / (R² + 0.01)", Direction::Less,
           squared_error<square_of>, squared_errors<square_of>, kRatios, square_of},
    Metric{"relmse.eps0.01.trim0.001",
           "the same without the 0.1 % largest pixels: biased low, never the only one",
           Direction::Less, relmse_trimmed, squared_errors<square_of>, kRatios, square_of},
    Metric{"mrse.eps0.01", "mean of (I-r1)(I-r2) / (R + 0.01), as grittmann2019 has it",
           Direction::Less, squared_error<value_of>, squared_errors<value_of>, kRatios, value_of},
    Metric{"mse", "mean of (I-r1)(I-r2)", Direction::Less, squared_error<one>, squared_errors<one>,
           kRatios, one},
    Metric{"smape.eps0.01", "mean of |I-R| / (|I| + |R| + 0.01); the noise of R counts",
           Direction::Less, smape, symmetric_errors, kRatios, nullptr},
    Metric{
        "flip.ldr.ppd67",
        "mean LDR-FLIP of I and R clamped to [0, 1], 67 pixels per degree; the noise of R counts",
        Direction::Less, mean_ldr_flip, ldr_flip_map, kRatios, nullptr},
    Metric{"flip.hdr.ppd67",
           "mean HDR-FLIP, 67 pixels per degree, ACES at exposures from R; the noise of R counts",
           Direction::Less, mean_hdr_flip, hdr_flip_map, kRatios, nullptr},
    Metric{"relmse.eps0.01.worst0.001",
           "share of the sum of (I-R)² / (R² + 0.01) in its 0.1 % largest pixels", Direction::None,
           share_of_worst_pixels, naive_relative_errors, kNothing, nullptr},
    Metric{"mean", "mean of I over pixels and channels", Direction::None, mean, nullptr, kNothing,
           nullptr},
    Metric{"luminance.rec709", "mean of 0.2126 I_r + 0.7152 I_g + 0.0722 I_b over pixels",
           Direction::None, mean_luminance, nullptr, kNothing, nullptr},
    Metric{"luminance.rec709.bias.eps1e-9",
           "(Y(I) - Y(R)) / (Y(R) + 1e-9), Y the mean luminance: one number, sign and all",
           Direction::None, bias_of_mean_luminance, nullptr, kNothing, nullptr},
};

}  // namespace

std::string to_string(Direction direction) {
    switch (direction) {
        case Direction::Less:
            return "less";
        case Direction::More:
            return "more";
        case Direction::None:
            break;
    }
    return "none";
}

std::string aggregation(const Metric& metric) {
    const bool has_ratios = metric.across_scenes == AcrossScenes::GeometricMeanOfRatios;
    return std::string("mean over seeds") +
           (has_ratios ? ", geometric mean of ratios across scenes" : "");
}

std::span<const Metric> metrics() { return kMetrics; }

const Metric& find_metric(const std::string& id) {
    const auto* found = std::ranges::find(kMetrics, id, &Metric::id);
    if (found != kMetrics.end()) return *found;
    std::string known;
    for (const Metric& metric : kMetrics) known.append(" ").append(metric.id);
    throw ParameterError("metrics", "unknown metric '" + id + "'; known:" + known);
}

void require_same_size(const Metric& metric, const Image& image, const ReferencePair& reference) {
    const auto size = [](const Image& i) {
        return std::to_string(i.width) + "x" + std::to_string(i.height);
    };
    const auto fits = [&image](const Image& other) {
        return other.width == image.width && other.height == image.height &&
               other.rgb.size() == image.rgb.size();
    };
    if (!fits(reference.a) || !fits(reference.b) || image.rgb.empty()) {
        throw Error(Errc::InvalidArgument, "measure " + std::string(metric.id) + ": the image is " +
                                               size(image) + ", the halves of its reference are " +
                                               size(reference.a) + " and " + size(reference.b));
    }
}

double measure(const Metric& metric, const Image& image, const ReferencePair& reference) {
    require_same_size(metric, image, reference);
    return metric.measure(image, reference);
}

std::vector<double> measure_map(const Metric& metric, const Image& image,
                                const ReferencePair& reference) {
    require_same_size(metric, image, reference);
    if (metric.map == nullptr) {
        throw Error(Errc::InvalidArgument,
                    "map " + std::string(metric.id) + ": it is one number, not one a pixel");
    }
    return metric.map(image, reference);
}

}  // namespace misbench
