// What a bidirectional method carries along a camera path, and the memory that it works in.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <vector>

#include "renderer/methods/pass_context.h"
#include "renderer/paths/path_weights.h"

namespace misbench {

// π r² of the smallest disk around a place that counts photons. Their places are rounded to floats:
// a smaller disk finds all of those at its centre or none, which is no measure of their density.
inline double smallest_merge_area(Vec3 place) {
    constexpr double kSpacings = 8;
    const float largest = std::max({std::abs(place.x), std::abs(place.y), std::abs(place.z)});
    const double radius = kSpacings * 0x1p-23 * double{largest};
    return M_PI * radius * radius;
}

struct FoundPhoton {
    const LightVertex* const* vertex;
    float distance2;
};

// Memory of one thread, kept from path to path.
struct Scratch {
    PathDensities densities;
    std::vector<PathVertex> camera;                // x_1, x_2, …
    LightVertex end;                               // x_n where a camera path finds the light
    std::vector<const LightVertex* const*> drawn;  // from the cache, to connect x_k to
    std::vector<FoundPhoton> found;                // around x_k
    PathWeights::Scratch weights;
};

// One estimate of a pixel.
struct Walk {
    Pixel pixel;
    std::uint32_t pixel_index;
    std::size_t chunk;
    Rng& rng;
    RayTracer& tracer;
    Scratch& scratch;
    Vec3 origin;       // x_0
    float radius = 0;  // of merging
    Rgb sum{};
};

// Where a camera path goes next.
struct Leg {
    Ray ray;
    double pdf_direction = 0;  // solid angle measure; Step::pdf_forward
    Rgb beta = kWhite;
    float eta = 1;       // of the medium at the path's end over the camera's
    float n_shared = 1;  // paths that share x_1, beta is divided by it
};

// Keeps the memory of threads that come and go.
class ScratchPool {
 public:
    // Lends a thread its memory.
    class Lease {
     public:
        explicit Lease(ScratchPool& pool) : pool_(pool), scratch_(pool.take()) {}
        ~Lease() { pool_.put_back(std::move(scratch_)); }
        Lease(const Lease&) = delete;
        Lease& operator=(const Lease&) = delete;
        Scratch& operator*() { return *scratch_; }

     private:
        ScratchPool& pool_;
        std::unique_ptr<Scratch> scratch_;
    };

 private:
    std::unique_ptr<Scratch> take() {
        const std::lock_guard lock(mutex_);
        if (free_.empty()) return std::make_unique<Scratch>();
        std::unique_ptr<Scratch> scratch = std::move(free_.back());
        free_.pop_back();
        return scratch;
    }
    void put_back(std::unique_ptr<Scratch> scratch) {
        const std::lock_guard lock(mutex_);
        free_.push_back(std::move(scratch));
    }

    std::mutex mutex_;
    std::vector<std::unique_ptr<Scratch>> free_;
};

}  // namespace misbench
