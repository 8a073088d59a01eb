#include "renderer/scene/light_sampler.h"

#include <array>

#include "renderer/base/names.h"

namespace misbench {
namespace {

std::variant<DiscreteDistribution, LightTree> build_uniform(std::span<const LightBounds> lights) {
    return DiscreteDistribution(std::vector<double>(lights.size(), 1));
}

std::variant<DiscreteDistribution, LightTree> build_power(std::span<const LightBounds> lights) {
    std::vector<double> powers;
    powers.reserve(lights.size());
    for (const LightBounds& light : lights) powers.push_back(light.power);
    return DiscreteDistribution(powers);
}

// The surfaces together and every light without one are alike.
std::variant<DiscreteDistribution, LightTree> build_area(std::span<const LightBounds> lights) {
    double area = 0;
    for (const LightBounds& light : lights) area += light.area;
    std::vector<double> weights;
    weights.reserve(lights.size());
    for (const LightBounds& light : lights) {
        weights.push_back(light.area > 0 ? light.area / area : 1);
    }
    return DiscreteDistribution(weights);
}

std::variant<DiscreteDistribution, LightTree> build_tree(std::span<const LightBounds> lights) {
    return LightTree(lights);
}

constexpr std::array kLightSelections{
    LightSelection{"uniform", "every light alike", build_uniform},
    LightSelection{"power", "in proportion to the luminance of the emitted power", build_power},
    LightSelection{"area",
                   "in proportion to the surface area; a light without surface as all surfaces",
                   build_area},
    LightSelection{"tree", "by power, distance and orientation bounds in a hierarchy", build_tree},
};

}  // namespace

std::span<const LightSelection> light_selections() { return kLightSelections; }

const LightSelection& find_light_selection(const std::string& name) {
    return find_named(kLightSelections, name, "light_selection", "light selection");
}

}  // namespace misbench
