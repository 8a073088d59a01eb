#include "renderer/scene/materials/dielectric.h"

#include "renderer/scene/refraction.h"

namespace misbench {
namespace {

// η of a transmission: the index on the side that wo is not on over the other.
float eta_across(const Encounter& e, float eta) { return e.inside ? 1 / eta : eta; }

BsdfSample mirror_sample(Vec3 wo, Rgb reflectance, float probability) {
    return {.wi = {-wo.x, -wo.y, wo.z},
            .weight = reflectance,
            .pdf = double{probability},
            .is_delta = true};
}

BsdfSample straight_sample(Vec3 wo, Rgb transmittance, float probability) {
    return {.wi = -wo, .weight = transmittance, .pdf = double{probability}, .is_delta = true};
}

}  // namespace

BsdfValue DielectricMaterial::evaluate(const Encounter& /*e*/, Vec3 /*wi*/) const { return {}; }

std::optional<BsdfSample> DielectricMaterial::sample(const Encounter& e, BsdfRandom u) const {
    const Parameters& p = parameters_;
    const float eta = eta_across(e, p.eta);
    const float reflectance = fresnel_dielectric(e.wo.z, eta);
    if (u.lobe < reflectance) return mirror_sample(e.wo, p.specular_reflectance, reflectance);
    return BsdfSample{.wi = {-e.wo.x / eta, -e.wo.y / eta, -refracted_cosine(e.wo.z, eta)},
                      .weight = refraction_scale(e.transport, eta) * p.specular_transmittance,
                      .pdf = double{1 - reflectance},
                      .is_delta = true,
                      .eta = eta};
}

BsdfValue ThinDielectricMaterial::evaluate(const Encounter& /*e*/, Vec3 /*wi*/) const { return {}; }

std::optional<BsdfSample> ThinDielectricMaterial::sample(const Encounter& e, BsdfRandom u) const {
    const Parameters& p = parameters_;
    const float once = fresnel_dielectric(e.wo.z, p.eta);
    // r + t² r (1 + r² + r⁴ + …) with t = 1 - r.
    const float reflectance = 2 * once / (1 + once);
    if (u.lobe < reflectance) return mirror_sample(e.wo, p.specular_reflectance, reflectance);
    return straight_sample(e.wo, p.specular_transmittance, 1 - reflectance);
}

Lobes RoughDielectricMaterial::lobes() const {
    return (is_index_matched(parameters_.eta) ? kDeltaLobe : kGlossyLobe) | kTransmissiveLobe;
}

BsdfValue RoughDielectricMaterial::evaluate(const Encounter& e, Vec3 wi) const {
    const Parameters& p = parameters_;
    if (is_index_matched(p.eta)) return {};
    const float eta = eta_across(e, p.eta);
    return with_microfacets(p.distribution, p.alpha, [&](const auto& facets) -> BsdfValue {
        // Reflect: f cos θ_i = F D G / (4 cos θ_o).                              [WMLT07 (20)]
        if (wi.z > 0) {
            const Vec3 h = normalized(e.wo + wi);
            const float fresnel = fresnel_dielectric(dot(e.wo, h), eta);
            const float specular =
                facets.density(h) * facets.masking(e.wo) * facets.masking(wi) / (4 * e.wo.z);
            return {fresnel * specular * p.specular_reflectance,
                    double{0.25F * fresnel * facets.visible_density_over_cosine(e.wo, h)}};
        }
        // Refract: f cos θ_i = (1 - F) D G (wo·h / cos θ_o) dω_h / dω_i.         [WMLT07 (21)]
        const auto facet = wi.z < 0 ? refracting_facet(e.wo, wi, eta) : std::nullopt;
        if (!facet) return {};
        const float through = (1 - facet->fresnel) * facet->cos_o * facet->dh_over_di;
        const float specular =
            facets.density(facet->h) * facets.masking(e.wo) * facets.masking(wi) / e.wo.z;
        return {refraction_scale(e.transport, eta) * through * specular * p.specular_transmittance,
                double{through * facets.visible_density_over_cosine(e.wo, facet->h)}};
    });
}

std::optional<BsdfSample> RoughDielectricMaterial::sample(const Encounter& e, BsdfRandom u) const {
    const Parameters& p = parameters_;
    if (is_index_matched(p.eta)) return straight_sample(e.wo, p.specular_transmittance, 1);
    const float eta = eta_across(e, p.eta);
    const Vec3 h = with_microfacets(p.distribution, p.alpha, [&](const auto& facets) {
        return facets.sample_visible(e.wo, u.direction);
    });
    if (u.lobe < fresnel_dielectric(dot(e.wo, h), eta)) {
        const Vec3 wi = mirrored(e.wo, h);
        if (wi.z <= 0) return std::nullopt;
        return sample_of(wi, evaluate(e, wi));
    }
    const std::optional<Vec3> wi = refracted(e.wo, h, eta);
    if (!wi || wi->z >= 0) return std::nullopt;
    return sample_of(*wi, evaluate(e, *wi), eta);
}

}  // namespace misbench
