#include "renderer/math/discrete_distribution.h"

#include <algorithm>
#include <limits>

namespace misbench {

DiscreteDistribution::DiscreteDistribution(std::span<const double> weights)
    : probabilities_(weights.size(), 0) {
    double total = 0;
    for (const double weight : weights) total += weight;
    if (!(total > 0)) return;
    double sum = 0;
    cumulative_.reserve(weights.size());
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const double probability = weights[i] / total;
        probabilities_[i] = probability;
        sum += probability;
        cumulative_.push_back(sum);
        if (probability > 0) least_probability_ = std::min(least_probability_, probability);
    }
    // Rounding must not leave a gap at the end, nor give it to one of probability 0.
    for (std::size_t i = weights.size(); i-- > 0;) {
        cumulative_[i] = 1;
        if (probabilities_[i] > 0) break;
    }

    std::uint32_t index = 0;
    guide_.reserve(weights.size());
    for (std::size_t i = 0; i < weights.size(); ++i) {
        // Not too late where u n is rounded up to i.
        const double lowest =
            (1 - 0x1p-50) * static_cast<double>(i) / static_cast<double>(weights.size());
        while (cumulative_[index] <= lowest) ++index;
        guide_.push_back(index);
    }
}

DiscreteDistribution::Choice DiscreteDistribution::select(double u) const {
    const auto bucket = static_cast<std::size_t>(u * static_cast<double>(guide_.size()));
    std::uint32_t index = guide_[std::min(bucket, guide_.size() - 1)];
    while (cumulative_[index] <= u) ++index;
    return {index, probabilities_[index]};
}

double DiscreteDistribution::rest(double u, std::uint32_t index) const {
    constexpr double kBelowOne = 1 - std::numeric_limits<double>::epsilon() / 2;
    const double begin = index == 0 ? 0 : cumulative_[index - 1];
    return std::clamp((u - begin) / (cumulative_[index] - begin), 0.0, kBelowOne);
}

std::size_t DiscreteDistribution::n_bytes() const {
    return (probabilities_.size() + cumulative_.size()) * sizeof(double) +
           guide_.size() * sizeof(std::uint32_t);
}

}  // namespace misbench
