// Range search over points: which photons lie within a distance of a place. Bits, order of answers
// included, do not depend on the number of threads that built it.
//
// A tree of boxes without pointers: the points are sorted along a Morton curve [Mor66]; every eight
// in a row are a leaf, every eight leaves in a row have their boxes in a node, every eight nodes in
// one of the next level. Nothing in it depends on a radius: no query visits more nodes than there
// are.
//
// [Mor66]  G. M. Morton, A computer oriented geodetic data base and a new technique in file
//          sequencing, 1966.
#pragma once

#include <xmmintrin.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "renderer/math/vec.h"

namespace misbench {

class ThreadPool;

class PhotonMap {
 public:
    // Memory is kept: a build of no more positions than an earlier one allocates none. A position
    // that is not finite is never found.
    void build(std::span<const Vec3> positions, ThreadPool& threads);

    // Calls found(index, squared distance) once for every position with distance < radius, always
    // in the same order for the same positions.
    //
    // The squared distance is dot(d, d) of d = position - centre, compared with radius · radius,
    // all in float. So a radius whose square underflows to 0 (below 3e-23) finds nothing, and an
    // infinite one all positions whose squared distance does not overflow.
    template <class Found>
    void query(Vec3 centre, float radius, const Found& found) const;

 private:
    static constexpr std::size_t kWidth = 8;  // points of a leaf, boxes of a node
    // So many levels of nodes hold more points than indices of 32 bits tell apart.
    static constexpr std::size_t kMaxLevels = 10;

    struct Points {
        alignas(32) std::array<float, kWidth> x, y, z;

        Vec3 at(std::size_t i) const { return {x[i], y[i], z[i]}; }
        void set(std::size_t i, Vec3 p) { x[i] = p.x, y[i] = p.y, z[i] = p.z; }
    };
    struct Leaf {
        Points position;  // NaN where there is none
        std::array<std::uint32_t, kWidth> index;
    };
    // The boxes around the leaves, or the nodes, of the level below; infinitely far where there is
    // none.
    struct Node {
        Points lower, upper;
    };
    struct Key {
        std::uint64_t morton;
        std::uint32_t index;
    };
    struct Box {
        Vec3 lower, upper;
    };

    Box bounds(std::span<const Vec3> positions, ThreadPool& threads);
    void make_keys(std::span<const Vec3> positions, ThreadPool& threads);
    void sort_keys(ThreadPool& threads);
    void make_leaves(std::span<const Vec3> positions, ThreadPool& threads);
    template <class Child>
    static void make_nodes(std::span<const Child> children, std::vector<Node>& nodes,
                           ThreadPool& threads);
    static Box around(const Leaf& leaf);
    static Box around(const Node& node);

    static unsigned boxes_within(const Node& node, Vec3 centre, float radius2);
    template <class Found>
    static void visit(const Leaf& leaf, Vec3 centre, float radius2, const Found& found);

    std::vector<Leaf> leaves_;
    std::array<std::vector<Node>, kMaxLevels> levels_;  // the first has the leaves' boxes
    std::size_t n_levels_ = 0;                          // the last has one node; 0: no points

    // Of the build alone.
    std::vector<Key> keys_;
    std::vector<Key> other_keys_;
    std::vector<std::uint32_t> histograms_;  // by chunk and digit
    std::vector<Box> chunk_bounds_;
};

// The boxes whose squared distance from the centre is below radius², as bits.
//
// No point is lost by rounding. Its difference from the centre is not smaller than the box's on any
// axis; subtraction, multiplication and addition in float are monotonic; so the squared distance of
// the box, summed in the same order, is not above the point's.
inline unsigned PhotonMap::boxes_within(const Node& node, Vec3 centre, float radius2) {
    unsigned bits = 0;
    for (std::size_t i = 0; i < kWidth; i += 4) {
        const auto outside = [i](const auto& lower, const auto& upper, float c) {
            const __m128 four_c = _mm_set1_ps(c);
            const __m128 below = _mm_load_ps(&lower[i]) - four_c;
            const __m128 above = four_c - _mm_load_ps(&upper[i]);
            return _mm_max_ps(_mm_max_ps(below, above), _mm_setzero_ps());
        };
        const __m128 x = outside(node.lower.x, node.upper.x, centre.x);
        const __m128 y = outside(node.lower.y, node.upper.y, centre.y);
        const __m128 z = outside(node.lower.z, node.upper.z, centre.z);
        const __m128 within = _mm_cmplt_ps(x * x + y * y + z * z, _mm_set1_ps(radius2));
        bits |= static_cast<unsigned>(_mm_movemask_ps(within)) << i;
    }
    return bits;
}

template <class Found>
void PhotonMap::visit(const Leaf& leaf, Vec3 centre, float radius2, const Found& found) {
    alignas(16) std::array<float, kWidth> distance2;
    unsigned bits = 0;
    for (std::size_t i = 0; i < kWidth; i += 4) {
        const __m128 x = _mm_load_ps(&leaf.position.x[i]) - _mm_set1_ps(centre.x);
        const __m128 y = _mm_load_ps(&leaf.position.y[i]) - _mm_set1_ps(centre.y);
        const __m128 z = _mm_load_ps(&leaf.position.z[i]) - _mm_set1_ps(centre.z);
        const __m128 sum = x * x + y * y + z * z;
        _mm_store_ps(&distance2[i], sum);
        const __m128 within = _mm_cmplt_ps(sum, _mm_set1_ps(radius2));
        bits |= static_cast<unsigned>(_mm_movemask_ps(within)) << i;
    }
    for (; bits != 0; bits &= bits - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(bits));
        found(leaf.index[i], distance2[i]);
    }
}

template <class Found>
void PhotonMap::query(Vec3 centre, float radius, const Found& found) const {
    if (n_levels_ == 0 || !(radius > 0)) return;
    const float radius2 = radius * radius;
    // The nodes on the way down, and which of their boxes are still to be visited.
    std::array<std::size_t, kMaxLevels> node;
    std::array<unsigned, kMaxLevels> todo;
    std::size_t level = n_levels_ - 1;
    node[level] = 0;
    todo[level] = boxes_within(levels_[level][0], centre, radius2);
    while (level < n_levels_) {
        if (todo[level] == 0) {
            ++level;
            continue;
        }
        const std::size_t child =
            kWidth * node[level] + static_cast<std::size_t>(std::countr_zero(todo[level]));
        todo[level] &= todo[level] - 1;
        if (level == 0) {
            visit(leaves_[child], centre, radius2, found);
        } else {
            --level;
            node[level] = child;
            todo[level] = boxes_within(levels_[level][child], centre, radius2);
        }
    }
}

}  // namespace misbench
