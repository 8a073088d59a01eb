#include "renderer/scene/material.h"

#include "renderer/math/warp.h"
#include "renderer/scene/ggx.h"

namespace misbench {
namespace {

// A smoother surface is treated as this rough: every lobe has a density.
constexpr float kMinAlpha = 1e-3F;

float schlick_weight(float cos_theta) {
    const float x = std::clamp(1 - cos_theta, 0.0F, 1.0F);
    const float x2 = x * x;
    return x2 * x2 * x;
}

// Unpolarised reflectance at a dielectric boundary seen from outside, eta = n_inside / n_outside.
float fresnel_dielectric(float cos_i, float eta) {
    const float sin2_t = std::max(0.0F, 1 - cos_i * cos_i) / (eta * eta);
    if (sin2_t >= 1) return 1;
    const float cos_t = std::sqrt(1 - sin2_t);
    const float parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    const float perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    return 0.5F * (parallel * parallel + perpendicular * perpendicular);
}

}  // namespace

BsdfValue DiffuseMaterial::evaluate(Vec3 /*wo*/, Vec3 wi) const {
    if (wi.z <= 0) return {};
    const float density = density_cosine_hemisphere(wi.z);
    return {density * reflectance, double{density}};
}

std::optional<BsdfSample> DiffuseMaterial::sample(Vec3 /*wo*/, BsdfRandom u) const {
    const Vec3 wi = warp_cosine_hemisphere(u.direction);
    if (wi.z <= 0) return std::nullopt;
    return BsdfSample{wi, reflectance, double{density_cosine_hemisphere(wi.z)}};
}

GenericMaterial::GenericMaterial(const Parameters& p)
    : base_color_(p.base_color),
      roughness_(p.roughness),
      ior_(p.ior),
      metallic_(p.metallic),
      diffuse_weight_(1 - p.metallic) {
    const float aspect = std::sqrt(1 - 0.9F * p.anisotropic);
    alpha_x_ = std::max(kMinAlpha, p.roughness * p.roughness / aspect);
    alpha_y_ = std::max(kMinAlpha, p.roughness * p.roughness * aspect);
    const float base_luminance = luminance(p.base_color);
    const Rgb hue = base_luminance > 0 ? (1 / base_luminance) * p.base_color : kWhite;
    tint_ = lerp(p.specular_tint, kWhite, hue);
    const float r = (p.ior - 1) / (p.ior + 1);
    specular_at_normal_ = lerp(p.metallic, r * r * tint_, p.base_color);
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
    const float retro = 2 * roughness_ * cos_half * cos_half;
    const float lobe =
        (1 - 0.5F * fo) * (1 - 0.5F * fi) + retro * (fo + fi + fo * fi * (retro - 1));
    return (diffuse_weight_ * lobe / kPi) * base_color_;
}

Rgb GenericMaterial::specular_tinted_fresnel(float cos_half) const {
    const Rgb metal = lerp(schlick_weight(cos_half), specular_at_normal_, kWhite);
    if (metallic_ == 1) return tint_ * metal;
    const float dielectric = fresnel_dielectric(cos_half, ior_);
    return tint_ * lerp(metallic_, Rgb{dielectric, dielectric, dielectric}, metal);
}

BsdfValue GenericMaterial::evaluate(Vec3 wo, Vec3 wi) const {
    if (wi.z <= 0 || wo.z <= 0) return {};
    const Ggx ggx{alpha_x_, alpha_y_};
    const Vec3 half = normalized(wo + wi);
    const float specular = ggx.density(half) * ggx.masking_shadowing(wo, wi) / (4 * wo.z * wi.z);
    Rgb f = specular * specular_tinted_fresnel(dot(wi, half));
    float pdf = ggx.reflected_density(wo, half);
    if (diffuse_weight_ > 0) {
        const float p_diffuse = diffuse_probability(wo);
        f += diffuse(wo, wi, half);
        pdf = p_diffuse * density_cosine_hemisphere(wi.z) + (1 - p_diffuse) * pdf;
    }
    return {wi.z * f, double{pdf}};
}

std::optional<BsdfSample> GenericMaterial::sample(Vec3 wo, BsdfRandom u) const {
    if (wo.z <= 0) return std::nullopt;
    Vec3 wi;
    if (u.lobe < diffuse_probability(wo)) {
        wi = warp_cosine_hemisphere(u.direction);
    } else {
        const Vec3 half = Ggx{alpha_x_, alpha_y_}.sample_visible(wo, u.direction);
        wi = 2 * dot(wo, half) * half - wo;
    }
    const BsdfValue value = evaluate(wo, wi);
    if (!(value.pdf > 0)) return std::nullopt;
    return BsdfSample{wi, static_cast<float>(1 / value.pdf) * value.f_cos, value.pdf};
}

}  // namespace misbench
