// Filters of estimates by pixel: planes of one float a pixel, row by row.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "renderer/math/vec.h"

namespace misbench {

class ThreadPool;

struct Plane {
    int width = 0;
    int height = 0;
    std::vector<float> values;

    Plane() = default;
    Plane(int w, int h, float value = 0)
        : width(w),
          height(h),
          values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), value) {}
};

// `passes` times the mean over a square of (2 radius + 1)² pixels, of those inside of the image.
// Eight passes of radius 1 are nearly a Gaussian of σ = √(2 · 8 / 3) pixels.
void box_filter(Plane& plane, int radius, int passes, ThreadPool& threads);

// What the camera sees in a pixel.
struct PixelFeature {
    Vec3 normal{};
    float distance = 0;  // 0: nothing
};
// Weighs the pixels of a Gaussian of σ = √(2 · passes / 3), cut at 3 σ, by their features too: by
// exp(-(1 - n·n')² / σ_n²) and exp(-((d - d') / (σ_d d))²).
void bilateral_filter(Plane& plane, int passes, std::span<const PixelFeature> features,
                      ThreadPool& threads);

}  // namespace misbench
