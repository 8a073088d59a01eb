// Importance sampling of many lights: a binary hierarchy of bounds, descended at random in
// proportion to what each half may give to the point at most [CK18], with the cone bounds and the
// treatment of infinite lights of [PJH23 §12.6.3].
//
// [CK18]   A. Conty Estevez, C. Kulla, Importance sampling of many lights with adaptive tree
//          splitting, 2018.
// [PJH23]  M. Pharr, W. Jakob, G. Humphreys, Physically Based Rendering, 4th edition, 2023.
//
// n infinite lights and the hierarchy are n + 1 equal choices, n where the hierarchy gives nothing
// to the point. Unlike in [PJH23], a descent never ends without a light: where a node's bounds
// cannot exclude a point that both of its children exclude, the child is chosen by power. So the
// probabilities sum to 1 wherever there is a choice. Lights without power are never chosen.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "renderer/scene/light_bounds.h"

namespace misbench {

class LightTree {
 public:
    explicit LightTree(std::span<const LightBounds> lights);

    // Absent where every light is known to give nothing to the point. 0 <= u < 1.
    std::optional<LightChoice> select(Vec3 from, double u) const;
    // Of select() choosing `light` from there: the very same number. Above 0 for every light with
    // power whose points and normals, as they were described, can send light to the point.
    double probability(std::uint32_t light, Vec3 from) const;

 private:
    // Some lights: all their points lie in a sphere, all their normals in a cone, and light leaves
    // within an angle of at most 90 degrees around a normal.
    struct Node {
        Vec3 centre;
        float radius;  // > 0
        Vec3 axis;
        float cos_normals;
        float sin_normals;  // beside the cosine, which hardly tells small angles apart
        float cos_emission;
        float power;             // > 0, in units of the strongest light's
        std::uint32_t children;  // index of the first of two, one behind the other; 0 at a leaf
        // Lights are ranked from left to right: those from this rank on are the second child's. At
        // a leaf: the light.
        std::uint32_t split;

        double importance(Vec3 from) const;
    };
    struct Cluster;
    struct Branches {
        double first, second;  // probabilities
    };

    Cluster build(std::span<Cluster> lights, std::size_t node, std::uint32_t first_rank, int depth);
    bool reaches(Vec3 from) const { return !nodes_.empty() && nodes_[0].importance(from) > 0; }
    Branches branches(const Node& node, Vec3 from) const;

    std::vector<Node> nodes_;              // the root first; one light to a leaf
    std::vector<std::uint32_t> infinite_;  // lights, those with power
    std::vector<std::uint32_t> ranks_;     // of each light, or one of the marks in the .cpp
};

}  // namespace misbench
