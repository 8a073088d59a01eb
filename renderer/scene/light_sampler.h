// Strategies of choosing one light to shine on a point, by name.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "renderer/math/discrete_distribution.h"
#include "renderer/scene/light_bounds.h"
#include "renderer/scene/light_tree.h"

namespace misbench {

struct LightSelection {
    std::string_view name;
    std::string_view summary;
    std::variant<DiscreteDistribution, LightTree> (*build)(std::span<const LightBounds> lights);
};

std::span<const LightSelection> light_selections();
// Throws ParameterError("light_selection", …) with the list of what is known.
const LightSelection& find_light_selection(const std::string& name);

// A light is known by its index among those that the sampler was built from.
class LightSampler {
 public:
    LightSampler(std::span<const LightBounds> lights, const LightSelection& selection)
        : sampler_(selection.build(lights)) {}

    using Choice = LightChoice;
    // Absent where every light is known to give nothing to the point (or there are none).
    // 0 <= u < 1.
    std::optional<Choice> select(Vec3 from, double u) const {
        if (const auto* tree = std::get_if<LightTree>(&sampler_)) return tree->select(from, u);
        const auto& fixed = *std::get_if<DiscreteDistribution>(&sampler_);
        if (fixed.empty()) return std::nullopt;
        const auto [index, probability] = fixed.select(u);
        return LightChoice{index, probability};
    }
    // Of select() choosing `light` from there: the very same number.
    double probability(std::uint32_t light, Vec3 from) const {
        if (const auto* tree = std::get_if<LightTree>(&sampler_)) {
            return tree->probability(light, from);
        }
        return std::get_if<DiscreteDistribution>(&sampler_)->probability(light);
    }
    // Whether u must be finer than the multiples of 2⁻²⁴ that Rng gives. From m equally likely
    // values of u, a light of probability p is chosen by p m of them, up to one more or fewer: its
    // light is then wrong by up to 1 / (p m) of itself, and lost if p < 1 / m.
    bool needs_fine_u() const {
        const auto* fixed = std::get_if<DiscreteDistribution>(&sampler_);
        return fixed == nullptr || fixed->least_probability() < kCoarseProbability;
    }

 private:
    // With 24 bits the share of a light of this probability is wrong by one part in 64 at most.
    static constexpr double kCoarseProbability = 0x1p-18;

    std::variant<DiscreteDistribution, LightTree> sampler_;
};

}  // namespace misbench
