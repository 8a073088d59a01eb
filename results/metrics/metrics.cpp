#include "results/metrics/metrics.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>

#include "renderer/base/error.h"

namespace misbench {
namespace {

// Keeps the relative error of black pixels finite.
constexpr double kEpsilon = 0.01;
// Share of the pixels that the trimmed metric leaves out.
constexpr double kTrimmed = 0.001;

struct Channel {
    double image, a, b;
    double squared_error() const { return (image - a) * (image - b); }
    // The denominator carries the reference's noise, which correlates with the numerator's: a
    // residue that falls with the reference's samples (simulated: +0.2 % at 64 times the samples
    // of the image). Only fixed weights from a third reference would remove it.
    double relative_squared_error() const {
        const double reference = 0.5 * (a + b);
        return squared_error() / (reference * reference + kEpsilon);
    }
    // grittmann2019 section 6 divides by the reference, not by its square.
    double squared_error_over_reference() const {
        return squared_error() / (0.5 * (a + b) + kEpsilon);
    }
};

// Mean over the channels, for each pixel in order.
std::vector<double> pixel_errors(const Image& image, const ReferencePair& reference,
                                 double (Channel::*error)() const) {
    std::vector<double> errors(image.n_pixels());
    for (std::size_t p = 0; p < errors.size(); ++p) {
        double sum = 0;
        for (std::size_t i = 3 * p; i < 3 * p + 3; ++i) {
            const Channel channel{.image = static_cast<double>(image.rgb[i]),
                                  .a = static_cast<double>(reference.a.rgb[i]),
                                  .b = static_cast<double>(reference.b.rgb[i])};
            sum += (channel.*error)();
        }
        errors[p] = sum / 3;
    }
    return errors;
}

double mean_of(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
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

std::vector<double> relative_squared_errors(const Image& image, const ReferencePair& reference) {
    return pixel_errors(image, reference, &Channel::relative_squared_error);
}

double relmse(const Image& image, const ReferencePair& reference) {
    return mean_of(relative_squared_errors(image, reference));
}

double relmse_trimmed(const Image& image, const ReferencePair& reference) {
    const auto errors = relative_squared_errors(image, reference);
    return trimmed_mean(errors,
                        static_cast<std::size_t>(kTrimmed * static_cast<double>(errors.size())));
}

std::vector<double> squared_errors_over_reference(const Image& image,
                                                  const ReferencePair& reference) {
    return pixel_errors(image, reference, &Channel::squared_error_over_reference);
}

double mrse(const Image& image, const ReferencePair& reference) {
    return mean_of(squared_errors_over_reference(image, reference));
}

std::vector<double> squared_errors(const Image& image, const ReferencePair& reference) {
    return pixel_errors(image, reference, &Channel::squared_error);
}

double mse(const Image& image, const ReferencePair& reference) {
    return mean_of(squared_errors(image, reference));
}

double mean(const Image& image, const ReferencePair&) {
    double sum = 0;
    for (const float value : image.rgb) sum += static_cast<double>(value);
    return sum / static_cast<double>(image.rgb.size());
}

// To add a metric: write its function above, add its row here. An id is never used again for
// another number; what changes a number changes the id.
constexpr std::array kMetrics{
    Metric{"relmse.eps0.01", "mean of (I-r1)(I-r2) / (R² + 0.01)", Direction::Less, relmse,
           relative_squared_errors},
    Metric{"relmse.eps0.01.trim0.001",
           "the same without the 0.1 % largest pixels: biased low, never the only one",
           Direction::Less, relmse_trimmed, relative_squared_errors},
    Metric{"mrse.eps0.01", "mean of (I-r1)(I-r2) / (R + 0.01), as grittmann2019 has it",
           Direction::Less, mrse, squared_errors_over_reference},
    Metric{"mse", "mean of (I-r1)(I-r2)", Direction::Less, mse, squared_errors},
    Metric{"mean", "mean of I over pixels and channels", Direction::None, mean, nullptr},
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

std::span<const Metric> metrics() { return kMetrics; }

const Metric& find_metric(const std::string& id) {
    const auto* found = std::ranges::find(kMetrics, id, &Metric::id);
    if (found != kMetrics.end()) return *found;
    std::string known;
    for (const Metric& metric : kMetrics) known.append(" ").append(metric.id);
    throw ParameterError("metrics", "unknown metric '" + id + "'; known:" + known);
}

namespace {

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

}  // namespace

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
