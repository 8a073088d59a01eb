// What multiple importance sampling needs of a full path, once and for all methods: the density of
// every vertex from both of its sides. From it follow the techniques that could have made the path,
// and their effective densities.
//
// A path x_0 … x_n has n edges; x_0 lies on the camera's lens, x_n on a light.
//
// C_i   density of x_i as sampled from its camera-side neighbour x_{i-1}, area measure; C_1 counts
//       one camera path a pixel
// L_i   density of x_i as sampled from its light-side neighbour x_{i+1}, area measure; L_n is the
//       light's choice and the point on it, L_{n-1} the direction of emission
// q_t   n_t p_t: the density of the path by technique t times its number of samples, for a pixel
//
// At an infinitely far light, x_n is a direction: C_n and L_n are in solid angle measure, and
// L_{n-1} is the density of the point of entry, projected. At a delta light C_n is 0, and L_n a
// probability. A delta scattering at x_i makes L_{i-1} and C_{i+1} probabilities times the Jacobian
// of the directions; no technique ends a subpath there.
//
// technique    q                                         made by
// hit          n_hit ∏_{i≤n} C_i                         a camera path that runs into the light
// nee          n_nee p_nee ∏_{i<n} C_i                   next event estimation at x_{n-1}
// light        n_light ∏_{i≥1} L_i                       a light path, connected to the camera
// connect k    n_connect ∏_{i≤k} C_i ∏_{i>k} L_i         1 <= k <= n-2, the edge from x_k to
// x_{k+1} merge k      n_merge π r² ∏_{i≤k} C_i ∏_{i≥k} L_i      1 <= k <= n-1, a photon near x_k
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "renderer/paths/scaled_product.h"

namespace misbench {

enum class TechniqueKind : std::uint8_t { Hit, NextEvent, Light, Connect, Merge };

// The techniques of a path are counted from 0: hit, nee, light, connect 1 … n-2, merge 1 … n-1.
struct Technique {
    TechniqueKind kind = TechniqueKind::Hit;
    int k = 0;  // of connect and merge: the edges of the camera's part

    bool operator==(const Technique&) const = default;
    int index(int n_edges) const {
        switch (kind) {
            case TechniqueKind::Connect:
                return 2 + k;
            case TechniqueKind::Merge:
                return n_edges + k;
            default:
                return static_cast<int>(kind);
        }
    }
};
inline int n_techniques(int n_edges) { return n_edges < 2 ? 1 : 2 * n_edges; }
Technique technique_at(int index, int n_edges);

// Counts the techniques of all path lengths from 0, by path length, then by index: paths of up to n
// edges have the keys below first_technique_key(n + 1).
inline int first_technique_key(int n_edges) { return n_edges * (n_edges - 1); }
inline int technique_key(int n_edges, Technique technique) {
    return first_technique_key(n_edges) + technique.index(n_edges);
}

// Numbers of samples; 0 where a technique is off.
struct TechniqueCounts {
    double hit = 1;      // of paths of more than one edge; those of one have no other technique
    double nee = 1;      // shadow rays a camera vertex
    double light = 0;    // light paths of the pass
    double connect = 0;  // connections a light vertex that each camera vertex makes, expected
    double merge = 0;    // light paths of the pass that are merged, times the probability to merge
    double split = 1;    // camera paths that share x_1: all samples of techniques with an own x_2
    // merge 1 is among the techniques.
    bool merge_first = false;
};

struct PathDensities {
    // By vertex, 0 … n; the elements 0 mean nothing. At least n + 1 elements, more are ignored.
    std::vector<double> from_camera;     // C_i
    std::vector<double> from_light;      // L_i
    std::vector<std::uint8_t> is_delta;  // scattering at x_i is a delta one
    int n_edges = 0;
    double next_event = 0;  // p_nee, in the measure of C_n
    double merge_area = 0;  // π r²

    // Makes room for a path of n edges; keeps what is there.
    void make_room(int n) {
        const auto size = static_cast<std::size_t>(n) + 1;
        if (from_camera.size() >= size) return;
        from_camera.resize(size);
        from_light.resize(size);
        is_delta.resize(size);
    }
};

// Scratch memory of one thread, kept from path to path.
template <class Real>
struct DensityScratch {
    std::vector<ScaledProduct<Real>> to_light;  // ∏ of L from a vertex to the light
    std::vector<ScaledProduct<Real>> products;  // by technique
    std::vector<double> q;
};

// q_t of all techniques of the path in units of the largest, in [0, 1], by index; 0 where a
// technique is off or cannot make the path. All are 0 where none can. The products are made in
// Real, of densities rounded to Real. Valid until the scratch is used again.
template <class Real>
std::span<double> effective_densities(const PathDensities& path, const TechniqueCounts& counts,
                                      DensityScratch<Real>& scratch);

extern template std::span<double> effective_densities<double>(const PathDensities&,
                                                              const TechniqueCounts&,
                                                              DensityScratch<double>&);
extern template std::span<double> effective_densities<float>(const PathDensities&,
                                                             const TechniqueCounts&,
                                                             DensityScratch<float>&);

}  // namespace misbench
