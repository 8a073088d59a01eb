#include "results/metrics/error_parts.h"

#include <cstddef>
#include <string>

#include "renderer/base/check.h"
#include "renderer/base/error.h"

namespace misbench {
namespace {

void require_squared_error(const Metric& metric, const std::string& what) {
    if (metric.denominator != nullptr) return;
    throw Error(Errc::InvalidArgument,
                what + " " + std::string(metric.id) + ": it is no mean of squared errors");
}

// Mean over pixels and channels of numerator(i), weighted like the metric.
template <typename Numerator>
double weighted_mean(const Metric& metric, const ReferencePair& reference,
                     const Numerator& numerator) {
    const std::vector<float>& a = reference.a.rgb;
    const std::vector<float>& b = reference.b.rgb;
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double mean = 0.5 * (static_cast<double>(a[i]) + static_cast<double>(b[i]));
        sum += numerator(i) / metric.denominator(mean);
    }
    return sum / static_cast<double>(a.size());
}

}  // namespace

ErrorPartsSum::ErrorPartsSum(const Metric& metric, const ReferencePair& reference)
    : metric_(metric),
      reference_(reference),
      mean_(reference.a.rgb.size()),
      squares_(reference.a.rgb.size()) {
    require_squared_error(metric, "variance and bias of");
    require_same_size(metric, reference.a, reference);
}

void ErrorPartsSum::add(const Image& image) {
    require_same_size(metric_, image, reference_);
    ++n_images_;
    for (std::size_t i = 0; i < mean_.size(); ++i) {
        const auto value = static_cast<double>(image.rgb[i]);
        const double before = value - mean_[i];
        mean_[i] += before / n_images_;
        squares_[i] += before * (value - mean_[i]);
    }
}

ErrorParts ErrorPartsSum::parts() const {
    MISBENCH_CHECK(n_images_ >= 2);
    const auto variance = [this](std::size_t i) { return squares_[i] / (n_images_ - 1); };
    const auto bias_squared = [&](std::size_t i) {
        return (mean_[i] - static_cast<double>(reference_.a.rgb[i])) *
                   (mean_[i] - static_cast<double>(reference_.b.rgb[i])) -
               variance(i) / n_images_;
    };
    return {.variance = weighted_mean(metric_, reference_, variance),
            .bias_squared = weighted_mean(metric_, reference_, bias_squared)};
}

double reference_noise(const Metric& metric, const ReferencePair& reference) {
    require_squared_error(metric, "noise of the reference in");
    require_same_size(metric, reference.a, reference);
    return weighted_mean(metric, reference, [&reference](std::size_t i) {
        const double half = 0.5 * (static_cast<double>(reference.a.rgb[i]) -
                                   static_cast<double>(reference.b.rgb[i]));
        return half * half;
    });
}

double reference_noise_share(double error, double reference_noise) {
    return reference_noise == 0 ? 0 : reference_noise / (error + reference_noise);
}

}  // namespace misbench
