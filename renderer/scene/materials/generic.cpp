#include "renderer/scene/materials/generic.h"

#include "renderer/math/warp.h"
#include "renderer/scene/microfacets.h"
#include "renderer/scene/refraction.h"

namespace misbench {
namespace {

// A smoother surface is treated as this rough: every lobe has a density.
constexpr float kMinAlpha = 1e-3F;

float schlick_weight(float cos_theta) {
    const float x = std::clamp(1 - cos_theta, 0.0F, 1.0F);
    const float x2 = x * x;
    return x2 * x2 * x;
}

}  // namespace

GenericMaterial::GenericMaterial(const Parameters& parameters) : parameters_(parameters) {
    prepare();
}

void GenericMaterial::set_color(Rgb color) {
    parameters_.base_color = color;
    prepare();
}

void GenericMaterial::set_roughness(float roughness) {
    parameters_.roughness = roughness;
    prepare();
}

void GenericMaterial::prepare() {
    const Parameters& p = parameters_;
    diffuse_weight_ = (1 - p.metallic) * (1 - p.specular_transmittance);
    is_straight_ = p.specular_transmittance > 0 && is_index_matched(p.ior);
    const float aspect = std::sqrt(1 - 0.9F * p.anisotropic);
    alpha_x_ = std::max(kMinAlpha, p.roughness * p.roughness / aspect);
    alpha_y_ = std::max(kMinAlpha, p.roughness * p.roughness * aspect);
    const float base_luminance = luminance(p.base_color);
    const Rgb hue = base_luminance > 0 ? (1 / base_luminance) * p.base_color : kWhite;
    tint_ = lerp(p.specular_tint, kWhite, hue);
    const float r = (p.ior - 1) / (p.ior + 1);
    specular_at_normal_ = lerp(p.metallic, r * r * tint_, p.base_color);
}

Lobes GenericMaterial::lobes() const {
    Lobes lobes = kGlossyLobe;
    if (diffuse_weight_ > 0) lobes |= kDiffuseLobe;
    if (parameters_.specular_transmittance > 0) lobes |= kTransmissiveLobe;
    if (is_straight_) lobes |= kDeltaLobe;
    return lobes;
}

// An opaque surface looks the same from both sides.
float GenericMaterial::eta_across(const Encounter& e) const {
    if (is_straight_) return 1;
    const bool leaves = e.inside && parameters_.specular_transmittance > 0;
    return leaves ? 1 / parameters_.ior : parameters_.ior;
}

// The diffuse lobe is chosen in proportion to what the specular one leaves at wo, and at least
// three times in four as often as its weight says.
float GenericMaterial::diffuse_probability(Vec3 wo) const {
    const float schlick = luminance(lerp(schlick_weight(wo.z), specular_at_normal_, kWhite));
    return std::max(1 - schlick, 0.75F) * diffuse_weight_;
}

Rgb GenericMaterial::diffuse(Vec3 wo, Vec3 wi, Vec3 half) const {
    const float fo = schlick_weight(wo.z);
    const float fi = schlick_weight(wi.z);
    const float cos_half = dot(wi, half);
    const float retro = 2 * parameters_.roughness * cos_half * cos_half;
    const float lobe =
        (1 - 0.5F * fo) * (1 - 0.5F * fi) + retro * (fo + fi + fo * fi * (retro - 1));
    return (diffuse_weight_ * lobe / kPi) * parameters_.base_color;
}

Rgb GenericMaterial::specular_tinted_fresnel(float cos_half, float eta) const {
    const Rgb metal = lerp(schlick_weight(cos_half), specular_at_normal_, kWhite);
    if (parameters_.metallic == 1) return tint_ * metal;
    const float dielectric = fresnel_dielectric(cos_half, eta);
    return tint_ * lerp(parameters_.metallic, Rgb{dielectric, dielectric, dielectric}, metal);
}

// Once a facet is chosen, refraction is in proportion to what it carries. A straight transmission
// comes from no facet: there it is decided at the macroscopic normal.
float GenericMaterial::transmission_probability(Vec3 wo, float cos_half, float eta) const {
    if (parameters_.specular_transmittance == 0) return 0;
    const float cos_facet = is_straight_ ? wo.z : cos_half;
    const float refracts =
        parameters_.specular_transmittance * (1 - fresnel_dielectric(cos_facet, eta));
    const float reflects = luminance(specular_tinted_fresnel(cos_facet, eta));
    return refracts > 0 ? refracts / (refracts + reflects) : 0;
}

BsdfValue GenericMaterial::evaluate_reflection(const Encounter& e, Vec3 wi) const {
    const Vec3 wo = e.wo;
    const Ggx ggx{alpha_x_, alpha_y_};
    const float eta = eta_across(e);
    const Vec3 half = normalized(wo + wi);
    const float cos_half = dot(wi, half);
    const float specular = ggx.density(half) * ggx.masking_shadowing(wo, wi) / (4 * wo.z * wi.z);
    Rgb f = specular * specular_tinted_fresnel(cos_half, eta);
    float pdf = 0.25F * ggx.visible_density_over_cosine(wo, half) *
                (1 - transmission_probability(wo, cos_half, eta));
    if (diffuse_weight_ > 0) {
        const float p_diffuse = diffuse_probability(wo);
        f += diffuse(wo, wi, half);
        pdf = p_diffuse * density_cosine_hemisphere(wi.z) + (1 - p_diffuse) * pdf;
    }
    return {wi.z * f, double{pdf}};
}

BsdfValue GenericMaterial::evaluate_refraction(const Encounter& e, Vec3 wi) const {
    if (parameters_.specular_transmittance == 0 || is_straight_) return {};
    const float eta = eta_across(e);
    const auto facet = refracting_facet(e.wo, wi, eta);
    if (!facet) return {};
    // f cos θ_i = (1 - F) D G (wo·h / cos θ_o) dω_h / dω_i.                     [WMLT07 (21)]
    const Ggx ggx{alpha_x_, alpha_y_};
    const float projected = facet->cos_o * facet->dh_over_di;
    const float f_cos = parameters_.specular_transmittance * (1 - facet->fresnel) * projected *
                        ggx.density(facet->h) * ggx.masking_shadowing(e.wo, wi) / e.wo.z;
    const float probability =
        (1 - diffuse_probability(e.wo)) * transmission_probability(e.wo, facet->cos_o, eta);
    return {refraction_scale(e.transport, eta) * f_cos * parameters_.base_color,
            double{probability * projected * ggx.visible_density_over_cosine(e.wo, facet->h)}};
}

BsdfValue GenericMaterial::evaluate(const Encounter& e, Vec3 wi) const {
    if (e.wo.z <= 0 || wi.z == 0) return {};
    return wi.z > 0 ? evaluate_reflection(e, wi) : evaluate_refraction(e, wi);
}

std::optional<BsdfSample> GenericMaterial::sample(const Encounter& e, BsdfRandom u) const {
    const Vec3 wo = e.wo;
    if (wo.z <= 0) return std::nullopt;
    const float p_diffuse = diffuse_probability(wo);
    if (u.lobe < p_diffuse) {
        const Vec3 wi = warp_cosine_hemisphere(u.direction);
        return sample_of(wi, evaluate(e, wi));
    }
    const float eta = eta_across(e);
    const Vec3 half = Ggx{alpha_x_, alpha_y_}.sample_visible(wo, u.direction);
    const float p_transmission = transmission_probability(wo, dot(wo, half), eta);
    if ((u.lobe - p_diffuse) < (1 - p_diffuse) * p_transmission) {
        if (is_straight_) return sample_straight(wo, (1 - p_diffuse) * p_transmission);
        const std::optional<Vec3> wi = refracted(wo, half, eta);
        if (!wi || wi->z >= 0) return std::nullopt;
        return sample_of(*wi, evaluate(e, *wi), eta);
    }
    const Vec3 wi = mirrored(wo, half);
    if (wi.z <= 0) return std::nullopt;
    return sample_of(wi, evaluate(e, wi));
}

BsdfSample GenericMaterial::sample_straight(Vec3 wo, float probability) const {
    return {.wi = -wo,
            .weight = (parameters_.specular_transmittance / probability) * parameters_.base_color,
            .pdf = double{probability},
            .is_delta = true};
}

}  // namespace misbench
