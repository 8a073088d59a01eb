// The seam between methods and everything that weighs or watches their samples: what a path shows
// of itself, and one event a sample.
#pragma once

#include <cstdint>
#include <span>

#include "renderer/paths/path_densities.h"
#include "renderer/scene/scene.h"

namespace misbench {

// A vertex as the subpath that made it knows it.
struct PathVertex {
    // Of an infinitely far light only the light's index; of a point in space also the position.
    SurfacePoint point{};
    Vec3 wo{};  // unit, towards the subpath's previous vertex; of a light's, where it emits to
    // What the subpath carries to here, Russian roulette included. Camera: ∏ f cosθ / p. Light: the
    // same times emission over its density, so that f cosθ / p is flux.
    Rgb beta{};
    bool is_delta = false;  // the subpath goes on from here by a delta lobe
};

// Densities are those of path_densities.h: pdf_forward is L_i, pdf_reverse C_i. The latter is known
// of vertices from which the path took two more steps.
struct alignas(64) LightVertex : PathVertex {
    double pdf_forward = 0;
    double pdf_reverse = 0;
    double next_event = 0;      // of the second vertex: the density p_nee of the first from here
    std::uint32_t n_edges = 0;  // from the light to here
    bool has_smooth_lobes = false;  // scatters by more than delta lobes
    bool is_infinite = false;       // of the first vertex
    bool is_delta_light = false;
};

struct Pixel {
    int x = 0;
    int y = 0;
    bool operator==(const Pixel&) const = default;
    // Row by row.
    std::size_t index(int width) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(x);
    }
};

// A full path x_0 … x_n. Valid during one event only.
struct PathView {
    const PathDensities* densities = nullptr;
    Pixel pixel{};
    Vec3 origin{};                         // x_0, on the lens
    std::span<const PathVertex> camera{};  // x_1, x_2, … as far as the camera's subpath goes
    // The light's subpath: y_0 on the light first, the last one is connected with the last of
    // `camera` or merged with it. One vertex where next event estimation found the light, or where
    // the camera's subpath left the scene; empty where that ran into the light.
    std::span<const LightVertex> light{};

    int n_edges() const { return densities->n_edges; }
    // x_i, 1 <= i <= n. Where the subpaths meet, the vertex' is_delta is what its subpath went on
    // by, the densities' is the path's.
    const PathVertex& vertex(int i) const {
        const auto at = static_cast<std::size_t>(i);
        if (at <= camera.size()) return camera[at - 1];
        return light[static_cast<std::size_t>(n_edges()) - at];
    }
};

struct Sample {
    const PathView& path;
    Technique technique{};
    Rgb value{};  // what the pixel would gain if the weight were 1; number of samples included
    double weight = 0;
    // Effective densities by index of technique, in units of the largest; empty where the method
    // has but one technique for such paths.
    std::span<const double> q{};
    std::span<const double> factors{};  // c_t by index; empty: all are 1
    // Of all techniques, by index: only where an observer wants them, and empty as q is.
    std::span<const double> weights{};
};

// Receives every sample of a pass. A phase is a part of a pass whose work is cut into chunks that
// do not depend on the number of threads; chunks run at the same time, the samples of one chunk in
// order. In the phase of the camera paths all samples of a pixel come from one chunk; in the one of
// the light paths they come from any. So what sums over pixels of light paths' samples is kept by
// chunk and added at the phase's end.
class SampleObserver {
 public:
    virtual ~SampleObserver() = default;
    // Whether samples without a contribution are wanted too: where next event estimation or a
    // connection found that the light is blocked or not scattered. Their paths are complete.
    virtual bool wants_zeros() const { return false; }
    // Whether Sample::weights are.
    virtual bool wants_weights() const { return false; }
    virtual void start_phase(std::size_t /*n_chunks*/) {}
    virtual void observe(const Sample& sample, std::size_t chunk) = 0;
    virtual void finish_phase() {}
};

}  // namespace misbench
