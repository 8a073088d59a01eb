// Next event estimation: a point on a light chosen from a surface point, and the density with
// which it would have been chosen.
#pragma once

#include <optional>

#include "renderer/base/rng.h"
#include "renderer/math/warp.h"
#include "renderer/scene/light_sampler.h"
#include "renderer/scene/scene.h"

namespace misbench {

class NextEvent {
 public:
    NextEvent(const Scene& scene, const LightSelection& selection)
        : scene_(scene), sampler_(scene.lights(), selection) {}

    struct Sample {
        SurfacePoint light;
        Vec3 wi;         // unit, from the surface towards the light
        Rgb radiance;    // emitted towards the surface; visibility is not tested
        double pdf = 0;  // solid angle measure at the surface, > 0
    };

    // Absent where the sample carries nothing: no lights, or seen from behind.
    std::optional<Sample> sample(const SurfacePoint& from, Rng& rng) const {
        const float select = rng.uniform();
        const float u = rng.uniform();
        const float v = rng.uniform();
        if (sampler_.empty()) return std::nullopt;
        const std::size_t index = sampler_.select(select);
        Sample sample;
        sample.light = scene_.point_on(scene_.lights()[index].triangle, warp_triangle({u, v}));
        const Vec3 edge = sample.light.position - from.position;
        if (dot(sample.light.normal, edge) == 0) return std::nullopt;
        sample.wi = normalized(edge);
        sample.radiance = scene_.emitted(sample.light, -sample.wi);
        if (sample.radiance == Rgb{}) return std::nullopt;
        sample.pdf = pdf(from, sample.light);
        return sample;
    }

    // Density of choosing `light`, a point on a light, from `from`; solid angle measure.
    double pdf(const SurfacePoint& from, const SurfacePoint& light) const {
        const double pdf_area =
            sampler_.probability(light.light) / double{scene_.lights()[light.light].area};
        return area_to_solid_angle(pdf_area, from, light);
    }

 private:
    const Scene& scene_;
    LightSampler sampler_;
};

}  // namespace misbench
