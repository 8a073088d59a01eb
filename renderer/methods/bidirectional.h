// Bidirectional light transport: camera paths and light paths, joined in every way that is switched
// on, every sample weighted against all ways that could have found it. The methods light, bdpt,
// photon and vcm are settings of this one.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "renderer/methods/parameters_of.h"
#include "renderer/weights/weighting.h"

namespace misbench {

// How large the disk is in which merging finds photons; one size for all techniques of a path.
enum class RadiusUnit : std::uint8_t {
    Footprint,  // the side of the pixel seen at x_1, across the camera ray
    Distance,   // |x_1 - x_0|
    Global,     // the scene's radius
};
enum class MergeKernel : std::uint8_t { Epanechnikov, Constant };

struct BidirectionalOptions {
    std::int64_t min_depth = 1;  // edges of a path, camera edge included
    std::int64_t max_depth = 8;
    std::int64_t rr_depth = 5;  // 0: no Russian roulette
    bool hit = false;           // of paths of more than one edge
    bool light = false;
    bool connect = false;
    bool merge = false;
    std::int64_t shadow_rays = 0;   // a camera vertex
    std::int64_t bsdf_samples = 1;  // camera paths that share their first vertex
    bool paired = false;            // connects to the pixel's own light path, not to the cache
    double connections = 1;         // a camera vertex, with the cache
    double light_paths = 1;         // over the number of pixels
    RadiusUnit radius_unit = RadiusUnit::Footprint;
    double radius_scale = 1;
    double radius_shrink = 1;  // α of r_i = r_1 i^((α-1)/2)
    MergeKernel kernel = MergeKernel::Epanechnikov;
    bool merge_first = false;  // at the first vertex too
    // Photon mapping: a camera path merges at its first vertex with a diffuse lobe, with weight 1,
    // and goes on from there by a delta lobe only. The other techniques are for paths without such
    // a vertex.
    bool merge_ends_path = false;
    WeightParameters weights = {};
    std::string light_selection = "power";
    DensityPrecision precision = DensityPrecision::Double;
};

std::unique_ptr<Method> make_bidirectional(const BidirectionalOptions& options);

// The catalogue's row of a method whose parameters P say what they mean by P::options().
template <class P>
constexpr MethodInfo bidirectional_info(std::string_view name, std::string_view summary,
                                        int version, std::string (*limits)(const SceneFeatures&)) {
    return method_info<P>(name, summary, version, false, limits,
                          [](const P& parameters) -> std::unique_ptr<Method> {
                              return make_bidirectional(parameters.options());
                          });
}

}  // namespace misbench
