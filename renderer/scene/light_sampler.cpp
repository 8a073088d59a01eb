#include "renderer/scene/light_sampler.h"

#include <algorithm>
#include <array>

#include "renderer/base/names.h"

namespace misbench {
namespace {

constexpr std::array kLightSelections{
    LightSelection{"uniform", "every emissive triangle alike",
                   [](const EmissiveTriangle&) { return 1.0; }},
    LightSelection{"power", "in proportion to area times luminance",
                   [](const EmissiveTriangle& light) {
                       return double{light.area} * double{luminance(light.radiance)};
                   }},
};

}  // namespace

std::span<const LightSelection> light_selections() { return kLightSelections; }

const LightSelection& find_light_selection(const std::string& name) {
    return find_named(kLightSelections, name, "light_selection", "light selection");
}

LightSampler::LightSampler(std::span<const EmissiveTriangle> lights,
                           const LightSelection& selection) {
    double total = 0;
    for (const EmissiveTriangle& light : lights) total += selection.importance(light);
    double sum = 0;
    for (const EmissiveTriangle& light : lights) {
        probabilities_.push_back(selection.importance(light) / total);
        sum += probabilities_.back();
        cumulative_.push_back(sum);
    }
    // Rounding must not leave a gap at the end, nor give it to a light of probability 0.
    for (std::size_t i = lights.size(); i-- > 0;) {
        cumulative_[i] = 1;
        if (probabilities_[i] > 0) break;
    }

    std::uint32_t light = 0;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const double lowest = static_cast<double>(i) / static_cast<double>(lights.size());
        while (cumulative_[light] <= lowest) ++light;
        guide_.push_back(light);
    }
}

std::size_t LightSampler::select(float u) const {
    const auto bucket = static_cast<std::size_t>(double{u} * static_cast<double>(guide_.size()));
    std::size_t light = guide_[bucket];
    while (cumulative_[light] <= double{u}) ++light;
    return light;
}

}  // namespace misbench
