// Reflection and refraction of directions at a boundary, and how much is reflected. As everywhere,
// directions point away from the surface.
//
// h    normal of the boundary or of a microfacet, unit, on the side of wo
// eta  refractive index behind the boundary over the one on the side of wo
//
// [WMLT07]  B. Walter et al., Microfacet models for refraction through rough surfaces, 2007.
#pragma once

#include <optional>

#include "renderer/math/vec.h"

namespace misbench {

inline Vec3 mirrored(Vec3 wo, Vec3 h) { return 2 * dot(wo, h) * h - wo; }

// Whether a rough boundary lets light pass straight on. Closer to one, the directions that it
// refracts into lie nearer to each other than their floats.
inline bool is_index_matched(float eta) { return std::abs(eta - 1) < 1e-4F; }

// cos θ_t > 0 by Snell's law, or 0: total reflection.
inline float refracted_cosine(float cos_o, float eta) {
    if (eta == 1) return cos_o;  // exactly: below, rounding is total reflection at grazing angles
    const float sin2_t = std::max(0.0F, 1 - cos_o * cos_o) / (eta * eta);
    return sin2_t < 1 ? std::sqrt(1 - sin2_t) : 0;
}

// Absent in total reflection.
inline std::optional<Vec3> refracted(Vec3 wo, Vec3 h, float eta) {
    const float cos_o = dot(wo, h);
    const float cos_t = refracted_cosine(cos_o, eta);
    if (cos_t == 0) return std::nullopt;
    return normalized((cos_o / eta - cos_t) * h - (1 / eta) * wo);
}

// Unpolarised reflectance of a boundary between dielectrics, by the cosines on both sides.
inline float fresnel_dielectric(float cos_o, float cos_t, float eta) {
    const float parallel = (eta * cos_o - cos_t) / (eta * cos_o + cos_t);
    const float perpendicular = (cos_o - eta * cos_t) / (cos_o + eta * cos_t);
    return 0.5F * (parallel * parallel + perpendicular * perpendicular);
}
inline float fresnel_dielectric(float cos_o, float eta) {
    const float cos_t = refracted_cosine(cos_o, eta);
    return cos_t > 0 ? fresnel_dielectric(cos_o, cos_t, eta) : 1;
}

// Unpolarised reflectance of a conductor of refractive index eta + i k, over the one outside.
inline float fresnel_conductor(float cos_o, float eta, float k) {
    const float cos2 = cos_o * cos_o;
    const float sin2 = 1 - cos2;
    // a² + b² with (a + i b)² = (eta + i k)² - sin² θ.
    const float real = eta * eta - k * k - sin2;
    const float norm = std::sqrt(real * real + 4 * eta * eta * k * k);
    const float a = std::sqrt(std::max(0.0F, 0.5F * (norm + real)));
    const float twice_a_cos = 2 * a * cos_o;
    const float perpendicular = (norm + cos2 - twice_a_cos) / (norm + cos2 + twice_a_cos);
    const float sum = norm * cos2 + sin2 * sin2;
    if (sum == 0) return 1;  // an index of 0, met straight on
    const float parallel = perpendicular * (sum - twice_a_cos * sin2) / (sum + twice_a_cos * sin2);
    return 0.5F * (perpendicular + parallel);
}
inline Rgb fresnel_conductor(float cos_o, Rgb eta, Rgb k) {
    return {fresnel_conductor(cos_o, eta.r, k.r), fresnel_conductor(cos_o, eta.g, k.g),
            fresnel_conductor(cos_o, eta.b, k.b)};
}

// The microfacet that refracts wo into wi.
struct RefractingFacet {
    Vec3 h;
    float cos_o;       // wo·h > 0
    float fresnel;     // its reflectance
    float dh_over_di;  // dω_h / dω_i
};

// Absent where no facet does: it would be seen from behind.                   [WMLT07 (16), (17)]
inline std::optional<RefractingFacet> refracting_facet(Vec3 wo, Vec3 wi, float eta) {
    const Vec3 sum = wo + eta * wi;
    const float length2 = dot(sum, sum);
    if (length2 == 0) return std::nullopt;
    const Vec3 h = (std::copysign(1.0F, sum.z) / std::sqrt(length2)) * sum;
    const float cos_o = dot(wo, h);
    const float cos_t = -dot(wi, h);
    if (cos_o <= 0 || cos_t <= 0) return std::nullopt;
    // (wo·h + eta wi·h)² is the length of the sum squared: h is its direction.
    return RefractingFacet{.h = h,
                           .cos_o = cos_o,
                           .fresnel = fresnel_dielectric(cos_o, cos_t, eta),
                           .dh_over_di = eta * eta * cos_t / length2};
}

}  // namespace misbench
