// The GGX microfacet distribution with height-correlated masking and shadowing [Hei14] and sampling
// of visible normals by spherical caps [DB23]. Local frame, z is the macroscopic normal.
//
// [Hei14]  E. Heitz, Understanding the masking-shadowing function in microfacet-based BRDFs, 2014.
// [DB23]   J. Dupuy, A. Benyoub, Sampling visible GGX normals with spherical caps, 2023.
#pragma once

#include "renderer/math/vec.h"

namespace misbench {

struct Ggx {
    float alpha_x;
    float alpha_y;

    // D(h), 1/sr; h.z > 0.
    float density(Vec3 h) const {
        const float x = h.x / alpha_x;
        const float y = h.y / alpha_y;
        const float s = x * x + y * y + h.z * h.z;
        return 1 / (kPi * alpha_x * alpha_y * s * s);
    }
    // Λ(w), w.z ≠ 0.
    float lambda(Vec3 w) const {
        const float x = alpha_x * w.x;
        const float y = alpha_y * w.y;
        return 0.5F * (std::sqrt(1 + (x * x + y * y) / (w.z * w.z)) - 1);
    }
    float masking(Vec3 w) const { return 1 / (1 + lambda(w)); }
    float masking_shadowing(Vec3 wo, Vec3 wi) const { return 1 / (1 + lambda(wo) + lambda(wi)); }

    // A normal h visible from wo (wo.z > 0).
    Vec3 sample_visible(Vec3 wo, Vec2 u) const {
        const Vec3 stretched = normalized({alpha_x * wo.x, alpha_y * wo.y, wo.z});
        const float phi = 2 * kPi * u.x;
        const float z = (1 - u.y) * (1 + stretched.z) - stretched.z;
        const float sin_theta = std::sqrt(std::clamp((1 - z) * (1 + z), 0.0F, 1.0F));
        const Vec3 cap = {sin_theta * std::cos(phi), sin_theta * std::sin(phi), z};
        const Vec3 h = cap + stretched;
        return normalized({alpha_x * h.x, alpha_y * h.y, std::max(0.0F, h.z)});
    }
    // Density of the direction wo mirrored at a visible normal, solid angle measure of wi:
    // G1(wo) D(h) / (4 wo.z).
    float reflected_density(Vec3 wo, Vec3 h) const { return masking(wo) * density(h) / (4 * wo.z); }
};

}  // namespace misbench
