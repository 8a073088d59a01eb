// Factors of samples that share a prefix, by how likely the prefix and the rest of the path are to
// be sampled again: grittmann2021.
#pragma once

#include <memory>
#include <string>

#include "renderer/paths/factor_provider.h"

namespace misbench {

struct CorrelationParameters {
    std::string radius = "distance";
    double scale = 1;
    bool bounded = true;

    static void fields(auto& self, auto&& field) {
        field("correlation_radius", self.radius,
              "unit of the radius within which a vertex is the same: distance (that of the camera "
              "ray, times the tangent of one degree), global (the scene's radius)");
        field("correlation_scale", self.scale, "the radius in that unit");
        field("correlation_bounded", self.bounded,
              "no factor is below 1 / number of samples that share the prefix");
    }
    void check() const;
};

std::shared_ptr<FactorProvider> make_correlation(const CorrelationParameters& parameters);

}  // namespace misbench
