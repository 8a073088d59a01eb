#include "renderer/scene/materials/conductor.h"

#include "renderer/scene/refraction.h"

namespace misbench {

BsdfValue ConductorMaterial::evaluate(const Encounter& /*e*/, Vec3 /*wi*/) const { return {}; }

std::optional<BsdfSample> ConductorMaterial::sample(const Encounter& e, BsdfRandom /*u*/) const {
    const Parameters& p = parameters_;
    return BsdfSample{.wi = {-e.wo.x, -e.wo.y, e.wo.z},
                      .weight = p.specular_reflectance * fresnel_conductor(e.wo.z, p.eta, p.k),
                      .pdf = 1,
                      .is_delta = true};
}

BsdfValue RoughConductorMaterial::evaluate(const Encounter& e, Vec3 wi) const {
    if (wi.z <= 0) return {};
    const Parameters& p = parameters_;
    return with_microfacets(p.distribution, p.alpha, [&](const auto& facets) -> BsdfValue {
        const Vec3 h = normalized(e.wo + wi);
        // f cos θ_i = F D G / (4 cos θ_o).                                       [WMLT07 (20)]
        const float specular =
            facets.density(h) * facets.masking(e.wo) * facets.masking(wi) / (4 * e.wo.z);
        const Rgb fresnel = fresnel_conductor(dot(wi, h), p.eta, p.k);
        return {specular * p.specular_reflectance * fresnel,
                double{0.25F * facets.visible_density_over_cosine(e.wo, h)}};
    });
}

std::optional<BsdfSample> RoughConductorMaterial::sample(const Encounter& e, BsdfRandom u) const {
    const Vec3 h = with_microfacets(
        parameters_.distribution, parameters_.alpha,
        [&](const auto& facets) { return facets.sample_visible(e.wo, u.direction); });
    const Vec3 wi = mirrored(e.wo, h);
    return sample_of(wi, evaluate(e, wi));
}

}  // namespace misbench
