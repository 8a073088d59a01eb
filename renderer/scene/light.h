// Lights: everything that emits, behind one set of questions.
#pragma once

#include <cstdint>

#include "renderer/math/vec.h"

namespace misbench {

struct Light {
    enum class Shape : std::uint8_t { Triangle, Quadric, Point, Spot, Directional, Environment };

    Shape shape = Shape::Triangle;
    std::uint32_t index = 0;  // of the triangle, quadric, or light of its kind
    float area = 0;           // m², > 0: of a triangle or quadric
    // Radiance of a surface on the side of its shading normal, intensity (W/sr) of a point or spot
    // light, irradiance across the direction of a directional one.
    Rgb emission{};

    bool is_surface() const { return shape == Shape::Triangle || shape == Shape::Quadric; }
    bool is_infinite() const { return shape == Shape::Directional || shape == Shape::Environment; }
    // Found by next event estimation only: no ray meets it.
    bool is_delta() const {
        return shape == Shape::Point || shape == Shape::Spot || shape == Shape::Directional;
    }
};

}  // namespace misbench
