// Strategies of choosing one emissive triangle, by name. A strategy gives each a fixed probability.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/math/vec.h"

namespace misbench {

// An emissive triangle of the scene.
struct EmissiveTriangle {
    std::uint32_t triangle = 0;
    float area = 0;  // > 0
    Rgb radiance;    // on the side of the shading normal
};

struct LightSelection {
    std::string_view name;
    std::string_view summary;
    double (*importance)(const EmissiveTriangle& light);  // ≥ 0, any scale
};

std::span<const LightSelection> light_selections();
// Throws ParameterError("light_selection", …) with the list of what is known.
const LightSelection& find_light_selection(const std::string& name);

class LightSampler {
 public:
    LightSampler(std::span<const EmissiveTriangle> lights, const LightSelection& selection);

    bool empty() const { return probabilities_.empty(); }
    // REQUIRES: not empty(), 0 <= u < 1.
    std::size_t select(float u) const;
    double probability(std::size_t light) const { return probabilities_[light]; }

 private:
    std::vector<double> probabilities_;
    std::vector<double> cumulative_;  // of the lights up to and with this one; the last is 1
    // guide_[i] is where the search for u in [i/n, (i+1)/n) begins: constant time on average.
    std::vector<std::uint32_t> guide_;
};

}  // namespace misbench
