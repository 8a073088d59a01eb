// Maps from the unit square to the domains that are sampled, each with its density beside it.
#pragma once

#include "renderer/math/vec.h"

namespace misbench {

// Cosine-weighted direction on the upper hemisphere; density z/π, solid angle measure.
inline Vec3 warp_cosine_hemisphere(Vec2 u) {
    const float radius = std::sqrt(u.x);
    const float phi = 2 * kPi * u.y;
    return {radius * std::cos(phi), radius * std::sin(phi), std::sqrt(std::max(0.0F, 1 - u.x))};
}
inline float density_cosine_hemisphere(float cos_theta) { return std::max(0.0F, cos_theta) / kPi; }

// Direction within a cap around +z, uniform; density 1 / (2π (1 - cos of its angle)), solid angle
// measure. The sphere is the cap of 1 - cos = 2.
inline Vec3 warp_cap(double one_minus_cos, Vec2 u) {
    const double below = double{u.x} * one_minus_cos;  // 1 - cos θ
    const double sin_theta = std::sqrt(below * (2 - below));
    const double phi = 2 * 3.14159265358979323846 * double{u.y};
    return {static_cast<float>(sin_theta * std::cos(phi)),
            static_cast<float>(sin_theta * std::sin(phi)), static_cast<float>(1 - below)};
}
inline Vec3 warp_sphere(Vec2 u) { return warp_cap(2, u); }

// Barycentric coordinates (of the second and third corner) uniform over a triangle; density
// 1/area, area measure.
inline Vec2 warp_triangle(Vec2 u) {
    const float root = std::sqrt(u.x);
    return {(1 - u.y) * root, u.y * root};
}

}  // namespace misbench
