// Random lights, by fixed seeds.
#pragma once

#include <cmath>
#include <vector>

#include "renderer/base/rng.h"
#include "renderer/scene/light_bounds.h"

namespace misbench::test {

inline Vec3 random_direction(Rng& rng) {
    const float z = 1 - 2 * rng.uniform();
    const float phi = 2 * kPi * rng.uniform();
    const float r = std::sqrt(std::max(0.0F, 1 - z * z));
    return normalized({r * std::cos(phi), r * std::sin(phi), z});
}

// In the cube of that half width.
inline Vec3 random_point(Rng& rng, float half_width) {
    const float x = rng.uniform();
    const float y = rng.uniform();
    const float z = rng.uniform();
    return half_width * Vec3{2 * x - 1, 2 * y - 1, 2 * z - 1};
}

// Small one-sided lamps of very different power, all over the cube of that half width and turned
// anywhere.
inline std::vector<LightBounds> random_lamps(int n, float half_width, std::uint32_t seed) {
    std::vector<LightBounds> lights;
    for (int i = 0; i < n; ++i) {
        Rng rng(seed, static_cast<std::uint32_t>(i), 0);
        LightBounds light;
        const Vec3 middle = random_point(rng, half_width);
        const float size = 0.01F * half_width;
        light.lower = middle - Vec3{size, size, size};
        light.upper = middle + Vec3{size, size, size};
        light.axis = random_direction(rng);
        light.cos_normals = 1;
        light.power = std::exp(6 * double{rng.uniform()} - 3);
        light.area = std::exp(6 * double{rng.uniform()} - 3);
        lights.push_back(light);
    }
    return lights;
}

// Of any kind but infinite: points to boxes as large as the cube, flat to all around.
inline std::vector<LightBounds> random_lights(int n, float half_width, std::uint32_t seed) {
    std::vector<LightBounds> lights = random_lamps(n, half_width, seed);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        LightBounds& light = lights[i];
        Rng rng(seed, static_cast<std::uint32_t>(i), 1);
        const auto kind = static_cast<int>(8 * rng.uniform());
        if (kind % 2 == 1) light.cos_normals = 1 - 2 * rng.uniform() * rng.uniform();
        if (kind / 4 == 1) light.cos_emission = 1 - 2 * rng.uniform();
        const Vec3 corner = random_point(rng, half_width * std::pow(10.0F, -8 * rng.uniform()));
        const Vec3 other = light.lower + corner;
        light.upper = {std::max(light.lower.x, other.x), std::max(light.lower.y, other.y),
                       std::max(light.lower.z, other.z)};
        light.lower = {std::min(light.lower.x, other.x), std::min(light.lower.y, other.y),
                       std::min(light.lower.z, other.z)};
    }
    return lights;
}

}  // namespace misbench::test
