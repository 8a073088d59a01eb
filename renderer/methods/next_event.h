// Next event estimation: a point on a light chosen from a surface point, and the density with
// which it would have been chosen.
#pragma once

#include <optional>

#include "renderer/base/rng.h"
#include "renderer/math/warp.h"
#include "renderer/methods/pass_context.h"
#include "renderer/scene/bsdf.h"
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

    // f cosθ Le w / p_l of one sample from a point, 0 where it carries nothing. weight(p_b, p_l) is
    // asked only for light that arrives; p_b is the density of BSDF sampling for its direction.
    template <class Weight>
    Rgb estimate(const SurfacePoint& from, const Bsdf& bsdf, Rng& rng, RayTracer& tracer,
                 const Weight& weight) const {
        const std::optional<Sample> light = sample(from, rng);
        if (!light) return {};
        const BsdfValue value = bsdf.evaluate(light->wi);
        if (value.f_cos == Rgb{} || !tracer.visible(from, light->light)) return {};
        const double w = weight(value.pdf, light->pdf);
        return static_cast<float>(w / light->pdf) * (value.f_cos * light->radiance);
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
