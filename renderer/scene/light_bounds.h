// What choosing among lights needs to know of one, and what a choice is.
#pragma once

#include <cstdint>

#include "renderer/math/vec.h"

namespace misbench {

struct LightBounds {
    double power = 0;  // luminance of the total emitted power, any common unit, >= 0, finite
    double area = 0;   // of its surface, any common unit; 0 where it has none
    bool is_infinite = false;  // environment or directional: no position; the rest is unused
    Vec3 lower, upper;         // of its points
    Vec3 axis{0, 0, 1};        // unit: middle of its normals
    float cos_normals = -1;    // all normals lie within this angle of the axis
    float cos_emission = 0;    // light leaves within this angle of a normal; 0: a half space;
                               // -1: all around
};

struct LightChoice {
    std::uint32_t light = 0;
    double probability = 0;  // > 0
};

}  // namespace misbench
