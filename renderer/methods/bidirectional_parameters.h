// Parameters that bidirectional methods share, by group: each method lists those that it has.
#pragma once

#include "renderer/methods/bidirectional.h"

namespace misbench {

struct PathLengthParameters {
    std::int64_t max_depth = 8;
    std::int64_t min_depth = 1;
    std::int64_t rr_depth = 5;

    static void fields(auto& self, auto&& field) {
        field("max_depth", self.max_depth, "edges of the longest path, the camera edge included");
        field("min_depth", self.min_depth, "edges of the shortest path that is counted");
        field("rr_depth", self.rr_depth,
              "edges after which Russian roulette may end a subpath, by its throughput; 0: never");
    }
    void check() const;
    void apply(BidirectionalOptions& options) const;
};

struct LightPathParameters {
    double light_paths = 1;
    std::string light_selection = "power";

    static void fields(auto& self, auto&& field) {
        field("light_paths", self.light_paths, "light paths a pixel; any number, 0 for none");
        field("light_selection", self.light_selection,
              "how one light is chosen among all; light paths take power for the tree");
    }
    void check() const;
    void apply(BidirectionalOptions& options) const;
};

struct ConnectionParameters {
    bool hit = true;
    bool nee = true;
    bool light = true;
    bool connect = true;
    std::string pairing = "cache";
    double connections = 1;
    std::int64_t shadow_rays = 1;
    std::int64_t bsdf_samples = 1;
    WeightParameters weights;
    std::string densities = "double";

    static void fields(auto& self, auto&& field) {
        field("hit", self.hit, "camera paths that run into lights");
        field("nee", self.nee, "next event estimation at every camera vertex");
        field("light", self.light, "light paths that are connected to the camera");
        field("connect", self.connect, "camera vertices that are connected to light vertices");
        field("pairing", self.pairing,
              "light vertices to connect to: cache (random ones of all paths), path (all of the "
              "pixel's own path)");
        field("connections", self.connections,
              "connections a camera vertex, with the cache; fractions are rounded at random");
        field("shadow_rays", self.shadow_rays, "light samples a camera vertex");
        field("bsdf_samples", self.bsdf_samples,
              "directions that a camera path goes on in at its first vertex");
        WeightParameters::fields(self.weights, field);
        field("densities", self.densities,
              "type in which densities are multiplied: double, float (to measure what it costs)");
    }
    void check();
    void apply(BidirectionalOptions& options) const;
};

struct MergeParameters {
    std::string radius = "footprint";
    double radius_scale = 1;
    double radius_shrink = 1;
    std::string kernel = "epanechnikov";

    static void fields(auto& self, auto&& field) {
        field("radius", self.radius,
              "unit of the merge radius: footprint (the pixel's side at the first vertex), "
              "distance (to the first vertex), global (the scene's radius)");
        field("radius_scale", self.radius_scale,
              "merge radius in that unit; at least 8 spacings of floats where the camera path "
              "first meets a surface");
        field("radius_shrink", self.radius_shrink,
              "α of r_i = r_1 i^((α-1)/2) in pass i; 1: fixed");
        field("kernel", self.kernel, "weight of photons by distance: epanechnikov, constant");
    }
    void check() const;
    void apply(BidirectionalOptions& options) const;
};

// MethodInfo::limits of methods that merge.
std::string limits_of_merging(const SceneFeatures& scene);

}  // namespace misbench
