// Next event estimation: a light chosen from a surface point, a point or direction of it, and the
// density with which it would have been chosen.
#pragma once

#include <optional>

#include "renderer/base/rng.h"
#include "renderer/methods/pass_context.h"
#include "renderer/scene/light_transport.h"

namespace misbench {

class NextEvent {
 public:
    NextEvent(const Scene& scene, const LightSelection& selection)
        : scene_(scene), sampler_(light_bounds(scene), selection) {}

    // Absent where the sample carries nothing. Its pdf counts the choice of the light: solid angle
    // measure, or the probability of a delta light. Visibility is not tested.
    template <bool kPlain = false>
    std::optional<LightEnd> sample(const SurfacePoint& from, Rng& rng) const {
        double select = double{rng.uniform()};
        if (sampler_.needs_fine_u()) select += 0x1p-24 * double{rng.uniform()};
        const float u = rng.uniform();
        const float v = rng.uniform();
        const auto choice = sampler_.select(from.position, select);
        if (!choice) return std::nullopt;
        std::optional<LightEnd> end;
        if constexpr (kPlain) {
            end = sample_triangle_light(scene_, choice->light, from.position, {u, v});
        } else {
            LightRandom random{.u = {u, v}};
            if (needs_finer(scene_.lights()[choice->light])) {
                random.finer.x = rng.uniform();
                random.finer.y = rng.uniform();
            }
            end = sample_light(scene_, choice->light, from.position, random);
        }
        if (end) end->pdf *= choice->probability;
        return end;
    }

    // f cosθ Le w / p_l of one sample from a point, 0 where it carries nothing. weight(p_b, p_l) is
    // asked only for light that arrives and that BSDF sampling could find; p_b is the density of
    // BSDF sampling for its direction. Other light has the weight `alone`.
    template <bool kPlain, class Bsdf, class Weight>
    Rgb estimate(const SurfacePoint& from, const Bsdf& bsdf, Rng& rng, RayTracer& tracer,
                 const Weight& weight, double alone = 1) const {
        const std::optional<LightEnd> light = sample<kPlain>(from, rng);
        if (!light) return {};
        const BsdfValue value = bsdf.evaluate(light->wi);
        if (value.f_cos == Rgb{} || !tracer.visible<kPlain>(from, *light)) return {};
        const double w = !kPlain && light->is_delta ? alone : weight(value.pdf, light->pdf);
        return static_cast<float>(w / light->pdf) * (value.f_cos * light->radiance);
    }

    // Density of choosing `light`, a point on a light, from `from`; solid angle measure.
    double pdf(Vec3 from, const SurfacePoint& light) const {
        return sampler_.probability(light.light, from) * light_pdf(scene_, from, light);
    }
    // The same in area measure.
    double pdf_area(Vec3 from, const SurfacePoint& light) const {
        return sampler_.probability(light.light, from) * light_pdf_area(scene_, from, light);
    }
    // Probability of choosing a light.
    double probability(Vec3 from, std::uint32_t light) const {
        return sampler_.probability(light, from);
    }
    // Density of choosing the environment's direction w. REQUIRES: the scene has an environment.
    double environment_pdf(Vec3 from, Vec3 w) const {
        return sampler_.probability(scene_.environment_light(), from) *
               scene_.environment()->pdf(w);
    }

 private:
    const Scene& scene_;
    LightSampler sampler_;
};

}  // namespace misbench
