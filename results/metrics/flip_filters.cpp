#include "results/metrics/flip_filters.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace misbench {
namespace {

constexpr double kPi = std::numbers::pi;

// One term of a channel's sensitivity in the frequency domain: a exp(-b f²).              [And20]
struct SensitivityTerm {
    double a, b;
};
constexpr std::array<std::array<SensitivityTerm, 2>, 3> kSensitivity{
    {{{{1.0, 0.0047}, {0.0, 1e-5}}},
     {{{1.0, 0.0053}, {0.0, 1e-5}}},
     {{{34.1, 0.04}, {13.5, 0.025}}}}};

// Degrees: the width of the feature detectors.                                            [And20]
constexpr double kFeatureWidth = 0.082;

std::vector<float> to_float(const std::vector<double>& values) {
    std::vector<float> result;
    for (const double value : values) result.push_back(static_cast<float>(value));
    return result;
}

// Three standard deviations of the widest term. All channels share it.                    [And20]
int contrast_radius(double pixels_per_degree) {
    double widest = 0;
    for (const auto& channel : kSensitivity) {
        for (const SensitivityTerm& term : channel) widest = std::max(widest, term.b);
    }
    return static_cast<int>(std::ceil(3 * std::sqrt(widest / (2 * kPi * kPi)) * pixels_per_degree));
}

// The positive weights over their sum, the negative ones over theirs.
void normalise_by_sign(std::vector<double>& weights) {
    double positive = 0;
    double negative = 0;
    for (const double w : weights) (w > 0 ? positive : negative) += std::abs(w);
    for (double& w : weights) w /= w > 0 ? positive : negative;
}

void add_scaled(float* out, const float* in, float factor, int n) {
    for (int i = 0; i < n; ++i) out[i] += factor * in[i];
}

std::size_t row_start(const Plane& plane, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(plane.width);
}

Plane length_of(const Plane& a, const Plane& b) {
    Plane length(a.width, a.height);
    for (std::size_t i = 0; i < length.values.size(); ++i) {
        length.values[i] = std::sqrt(a.values[i] * a.values[i] + b.values[i] * b.values[i]);
    }
    return length;
}

}  // namespace

Plane filter_rows(const Plane& in, const FilterWeights& weights) {
    Plane out(in.width, in.height);
    const auto radius = static_cast<std::ptrdiff_t>(weights.size() / 2);
    std::vector<float> padded(static_cast<std::size_t>(in.width) + weights.size() - 1);
    for (int y = 0; y < in.height; ++y) {
        const auto first = in.values.begin() + static_cast<std::ptrdiff_t>(row_start(in, y));
        const auto last = first + in.width;
        std::fill_n(padded.begin(), radius, *first);
        std::copy(first, last, padded.begin() + radius);
        std::fill_n(padded.begin() + radius + in.width, radius, *(last - 1));
        float* row = out.values.data() + row_start(out, y);
        for (std::size_t k = 0; k < weights.size(); ++k) {
            add_scaled(row, padded.data() + k, weights[k], in.width);
        }
    }
    return out;
}

Plane filter_columns(const Plane& in, const FilterWeights& weights) {
    Plane out(in.width, in.height);
    const int radius = static_cast<int>(weights.size() / 2);
    for (int y = 0; y < in.height; ++y) {
        float* row = out.values.data() + row_start(out, y);
        for (std::size_t k = 0; k < weights.size(); ++k) {
            const int source = std::clamp(y + static_cast<int>(k) - radius, 0, in.height - 1);
            add_scaled(row, in.values.data() + row_start(in, source), weights[k], in.width);
        }
    }
    return out;
}

ContrastFilters contrast_filters(double pixels_per_degree) {
    const int radius = contrast_radius(pixels_per_degree);
    ContrastFilters filters;
    for (std::size_t channel = 0; channel < 3; ++channel) {
        double volume = 0;
        for (const auto& [a, b] : kSensitivity[channel]) {
            if (a == 0) continue;
            std::vector<double> weights;
            double sum = 0;
            for (int i = -radius; i <= radius; ++i) {
                const double degrees = i / pixels_per_degree;
                weights.push_back(std::exp(-kPi * kPi * degrees * degrees / b));
                sum += weights.back();
            }
            for (double& w : weights) w /= sum;
            const double share = a * std::sqrt(kPi / b) * sum * sum;
            filters.parts[channel].push_back({.share = share, .weights = to_float(weights)});
            volume += share;
        }
        for (auto& part : filters.parts[channel]) part.share /= volume;
    }
    return filters;
}

Plane filter_contrast(const Plane& in, const std::vector<ContrastFilters::Part>& parts) {
    Plane sum(in.width, in.height);
    for (const auto& [share, weights] : parts) {
        const Plane part = filter_columns(filter_rows(in, weights), weights);
        for (std::size_t i = 0; i < sum.values.size(); ++i) {
            sum.values[i] += static_cast<float>(share) * part.values[i];
        }
    }
    return sum;
}

FeatureFilters feature_filters(double pixels_per_degree) {
    const double deviation = 0.5 * kFeatureWidth * pixels_per_degree;
    const int radius = static_cast<int>(std::ceil(3 * deviation));
    std::vector<double> smooth;
    std::vector<double> edge;
    std::vector<double> point;
    double sum = 0;
    for (int i = -radius; i <= radius; ++i) {
        const double t = i / deviation;
        const double gauss = std::exp(-0.5 * t * t);
        smooth.push_back(gauss);
        edge.push_back(-t * gauss);
        point.push_back((t * t - 1) * gauss);
        sum += gauss;
    }
    for (double& w : smooth) w /= sum;
    normalise_by_sign(edge);
    normalise_by_sign(point);
    return {.smooth = to_float(smooth), .edge = to_float(edge), .point = to_float(point)};
}

Features find_features(const Plane& in, const FeatureFilters& filters) {
    const Plane smooth_rows = filter_rows(in, filters.smooth);
    return {.edges = length_of(filter_columns(filter_rows(in, filters.edge), filters.smooth),
                               filter_columns(smooth_rows, filters.edge)),
            .points = length_of(filter_columns(filter_rows(in, filters.point), filters.smooth),
                                filter_columns(smooth_rows, filters.point))};
}

}  // namespace misbench
