#include "renderer/scene/materials/diffuse.h"

#include "renderer/math/warp.h"

namespace misbench {

BsdfValue DiffuseMaterial::evaluate(const Encounter& /*e*/, Vec3 wi) const {
    if (wi.z <= 0) return {};
    const float density = density_cosine_hemisphere(wi.z);
    return {density * reflectance, double{density}};
}

std::optional<BsdfSample> DiffuseMaterial::sample(const Encounter& /*e*/, BsdfRandom u) const {
    const Vec3 wi = warp_cosine_hemisphere(u.direction);
    if (wi.z <= 0) return std::nullopt;
    return BsdfSample{
        .wi = wi, .weight = reflectance, .pdf = double{density_cosine_hemisphere(wi.z)}};
}

RoughDiffuseMaterial::RoughDiffuseMaterial(const Parameters& parameters) : parameters_(parameters) {
    const float sigma2 = 0.5F * parameters.alpha * parameters.alpha;
    c1_ = 1 - 0.5F * sigma2 / (sigma2 + 0.33F);
    c2_ = 0.45F * sigma2 / (sigma2 + 0.09F);
    c3_ = 0.125F * sigma2 / (sigma2 + 0.09F);
    c4_ = 0.17F * sigma2 / (sigma2 + 0.13F);
}

BsdfValue RoughDiffuseMaterial::evaluate(const Encounter& e, Vec3 wi) const {
    if (wi.z <= 0) return {};
    // a and b: the larger and the smaller angle to the normal.
    const float cos_a = std::min(1.0F, std::min(e.wo.z, wi.z));
    const float cos_b = std::min(1.0F, std::max(e.wo.z, wi.z));
    const float sin_a = std::sqrt(1 - cos_a * cos_a);
    const float sin_b = std::sqrt(1 - cos_b * cos_b);
    const float a = std::acos(cos_a);
    const float b = std::acos(cos_b);
    // Cosine of the angle between the directions around the normal, any at the normal itself.
    const float sines = sin_a * sin_b;
    const float cos_phi =
        sines > 1e-8F ? std::clamp((e.wo.x * wi.x + e.wo.y * wi.y) / sines, -1.0F, 1.0F) : 0;

    // Light scattered once: C1 + cos φ C2 tan b + (1 - |cos φ|) C3 tan((a + b) / 2).
    const float b_turn = 2 * b / kPi;
    const float ab_turn = 4 * a * b / (kPi * kPi);
    const float c2 = c2_ * (cos_phi > 0 ? sin_a : sin_a - b_turn * b_turn * b_turn);
    const float c3 = c3_ * ab_turn * ab_turn;
    const float once = c1_ + cos_phi * c2 * sin_b / cos_b +
                       (1 - std::abs(cos_phi)) * c3 * (sin_a + sin_b) / (cos_a + cos_b);
    // Light scattered twice.
    const float twice = c4_ * (1 - cos_phi * b_turn * b_turn);

    const Rgb rho = parameters_.reflectance;
    const float density = density_cosine_hemisphere(wi.z);
    // The fits fall below zero for dark and very rough surfaces, both directions grazing.
    const auto channel = [&](float r) { return density * r * std::max(0.0F, once + r * twice); };
    return {{channel(rho.r), channel(rho.g), channel(rho.b)}, double{density}};
}

std::optional<BsdfSample> RoughDiffuseMaterial::sample(const Encounter& e, BsdfRandom u) const {
    const Vec3 wi = warp_cosine_hemisphere(u.direction);
    return sample_of(wi, evaluate(e, wi));
}

}  // namespace misbench
