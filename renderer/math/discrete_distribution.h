// A choice among n things in proportion to their weights, in constant time on average.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace misbench {

class DiscreteDistribution {
 public:
    DiscreteDistribution() = default;
    explicit DiscreteDistribution(std::span<const double> weights);  // >= 0 and finite, any scale

    struct Choice {
        std::uint32_t index = 0;
        double probability = 0;  // > 0
    };
    // All weights are 0: there is no choice.
    bool empty() const { return guide_.empty(); }
    // REQUIRES: not empty(), 0 <= u < 1.
    Choice select(double u) const;
    // What is left of u once select(u) chose `index`: uniform in [0, 1) again.
    double rest(double u, std::uint32_t index) const;
    double probability(std::uint32_t index) const { return probabilities_[index]; }
    // The smallest one above 0; 1 where there is none.
    double least_probability() const { return least_probability_; }
    std::size_t n_bytes() const;

 private:
    std::vector<double> probabilities_;
    std::vector<double> cumulative_;  // of all up to and with this one; the last is 1
    // guide_[i] is where the search for u in [i/n, (i+1)/n) begins. Empty where no weight is above
    // 0.
    std::vector<std::uint32_t> guide_;
    double least_probability_ = 1;
};

}  // namespace misbench
