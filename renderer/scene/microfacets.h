// Distributions of microfacet normals h: Beckmann's and GGX, with Smith's masking and sampling of
// the normals that are visible from wo. Local frame, z is the macroscopic normal.
//
// density(h)                         D(h), 1/sr; h.z > 0
// masking(w)                         G1(w), w.z ≠ 0, for facets that face w
// sample_visible(wo, u)              a normal, wo.z > 0
// visible_density_over_cosine(wo, h) its density over wo·h. A direction mirrored at h has a fourth
//                                    of this as its density, solid angle measure
//
// [WMLT07] B. Walter et al., Microfacet models for refraction through rough surfaces, 2007.
// [Hei14]  E. Heitz, Understanding the masking-shadowing function in microfacet-based BRDFs, 2014.
// [Jak14]  W. Jakob, An improved visible normal sampling routine for the Beckmann distribution,
//          2014.
// [DB23]   J. Dupuy, A. Benyoub, Sampling visible GGX normals with spherical caps, 2023.
#pragma once

#include <cstdint>

#include "renderer/math/vec.h"

namespace misbench {

// Which distribution a rough material has, as scene files name them.
enum class Microfacets : std::uint8_t { Beckmann, Ggx };

struct Ggx {
    float alpha_x;
    float alpha_y;

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
    // Of both directions, correlated by the height of the facets.                  [Hei14 (99)]
    float masking_shadowing(Vec3 wo, Vec3 wi) const { return 1 / (1 + lambda(wo) + lambda(wi)); }

    Vec3 sample_visible(Vec3 wo, Vec2 u) const {  // [DB23]
        const Vec3 stretched = normalized({alpha_x * wo.x, alpha_y * wo.y, wo.z});
        const float phi = 2 * kPi * u.x;
        const float z = (1 - u.y) * (1 + stretched.z) - stretched.z;
        const float sin_theta = std::sqrt(std::clamp((1 - z) * (1 + z), 0.0F, 1.0F));
        const Vec3 cap = {sin_theta * std::cos(phi), sin_theta * std::sin(phi), z};
        const Vec3 h = cap + stretched;
        return normalized({alpha_x * h.x, alpha_y * h.y, std::max(0.0F, h.z)});
    }
    // G1(wo) D(h) / wo.z.
    float visible_density_over_cosine(Vec3 wo, Vec3 h) const {
        return masking(wo) * density(h) / wo.z;
    }
};

struct Beckmann {
    float alpha;

    float density(Vec3 h) const {
        const float cos2 = h.z * h.z;
        const float exponent = (h.x * h.x + h.y * h.y) / (alpha * alpha * cos2);
        // Beyond, D is below 1e-20 of its peak: nothing, before it is too small for a float.
        if (!(exponent < 46)) return 0;
        return std::exp(-exponent) / (kPi * alpha * alpha * cos2 * cos2);
    }
    // Within 0.35 % of Smith's.                                                    [WMLT07 (27)]
    float masking(Vec3 w) const {
        const float a = cot_over_alpha(w);
        if (a >= 1.6F) return 1;
        return a * (3.535F + 2.181F * a) / (1 + a * (2.276F + 2.577F * a));
    }
    Vec3 sample_visible(Vec3 wo, Vec2 u) const;
    // With Smith's exact masking, by which the density integrates to one.
    float visible_density_over_cosine(Vec3 wo, Vec3 h) const;

 private:
    float cot_over_alpha(Vec3 w) const {
        return std::abs(w.z) / (alpha * std::sqrt(w.x * w.x + w.y * w.y));
    }
};

// function(distribution), of the kind.
template <class Function>
auto with_microfacets(Microfacets kind, float alpha, Function&& function) {
    return kind == Microfacets::Beckmann ? function(Beckmann{alpha}) : function(Ggx{alpha, alpha});
}

}  // namespace misbench
