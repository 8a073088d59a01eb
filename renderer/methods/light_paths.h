// The light paths of one pass: traced once, then seen by all pixels.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "renderer/methods/next_event.h"
#include "renderer/paths/sample.h"

namespace misbench {

class LightPaths {
 public:
    struct Limits {
        std::int64_t max_edges = 0;  // of a light path
        std::int64_t rr_depth = 0;   // edges after which Russian roulette may end it; 0: never
    };

    // The light of an emission is chosen by `selection` where that does not depend on a place, else
    // by power.
    LightPaths(const Scene& scene, const LightSelection& selection, const NextEvent& next_event);

    // How many are `per_pixel` of an image. Throws InvalidArgument where they are too many.
    static std::int64_t count(double per_pixel, FrameInfo frame);

    // Replaces all paths. Memory is kept.
    template <bool kPlain>
    void trace(PassContext& context, std::int64_t n_paths, const Limits& limits);

    std::int64_t size() const { return static_cast<std::int64_t>(paths_.size()); }
    // y_0 on the light, y_1, …; empty where the light emitted nothing.
    std::span<const LightVertex> path(std::int64_t i) const {
        return paths_[static_cast<std::size_t>(i)];
    }
    // All vertices that scatter other than by delta lobes, from y_1 on, path by path.
    std::span<const LightVertex* const> vertices() const { return vertices_; }

    // L of the two vertices of a light path's first edge, were it sampled by the light: from
    // `point` on the light (or far outside, `light` alone matters then) into direction w to `to`.
    struct FirstEdge {
        double light = 0;  // L_n
        double to = 0;     // L_{n-1}
    };
    FirstEdge first_edge(std::uint32_t light, const SurfacePoint& point, Vec3 w,
                         const SurfacePoint& to) const;

 private:
    double next_event_density(const LightVertex& light, Vec3 from) const;
    template <bool kPlain>
    void trace_path(Rng& rng, RayTracer& tracer, const Limits& limits,
                    std::vector<LightVertex>& vertices) const;

    const Scene& scene_;
    const NextEvent& next_event_;
    LightSampler sampler_;
    std::vector<std::vector<LightVertex>> chunks_;
    std::vector<std::vector<std::uint32_t>> path_ends_;  // by chunk and path: index behind its last
    std::vector<std::span<const LightVertex>> paths_;
    std::vector<const LightVertex*> vertices_;
};

// C of a light path's vertex: the density `pdf` of its direction, solid angle measure, in the
// measure that path_densities.h asks for. 0 where no direction meets the light.
double reverse_density(double pdf, Vec3 from, const LightVertex& to);

// A vertex of a light path and all before it.
inline std::span<const LightVertex> light_path_to(const LightVertex& vertex) {
    return {&vertex - vertex.n_edges, std::size_t{vertex.n_edges} + 1};
}

// Asks memory for a vertex that will be read soon.
inline void prefetch(const LightVertex& vertex) {
    static_assert(sizeof vertex == 128);  // two cache lines
    __builtin_prefetch(&vertex);
    __builtin_prefetch(reinterpret_cast<const std::byte*>(&vertex) + 64);
}

// The light's part of a full path: y_m … y_0 become x_{n-m} … x_n.
inline void append_light(PathDensities& d, std::span<const LightVertex> light, std::size_t m) {
    const auto n = static_cast<std::size_t>(d.n_edges);
    for (std::size_t j = 0; j <= m; ++j) {
        d.from_light[n - j] = light[j].pdf_forward;
        d.from_camera[n - j] = light[j].pdf_reverse;
        d.is_delta[n - j] = light[j].is_delta ? 1 : 0;
    }
    d.next_event = light[1].next_event;
}

}  // namespace misbench
