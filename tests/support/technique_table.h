// The table of path_densities.h, row by row: the effective density of one technique as the product
// that is written there.
#pragma once

#include <algorithm>
#include <cmath>

#include "renderer/paths/path_densities.h"

namespace misbench::test {

// A product with an exponent of its own that is put aside after each step: 64 bits, any range.
struct LongProduct {
    long double significand = 1;
    std::int64_t exponent = 0;

    void multiply(double factor) {
        int e = 0;
        significand = std::frexp(significand * factor, &e);
        exponent = significand == 0 ? 0 : exponent + e;
    }
    double log2() const { return static_cast<double>(std::log2(significand)) + double(exponent); }
    // This over another one.
    long double over(const LongProduct& o) const {
        const auto e = std::clamp<std::int64_t>(exponent - o.exponent, -30'000, 30'000);
        return std::ldexp(significand / o.significand, static_cast<int>(e));
    }
    bool operator<(const LongProduct& o) const {
        if (significand == 0 || o.significand == 0) return significand < o.significand;
        return exponent != o.exponent ? exponent < o.exponent : significand < o.significand;
    }
};

struct WeighedPath {
    PathDensities densities;
    TechniqueCounts counts;

    int n() const { return densities.n_edges; }
    double camera(int i) const { return densities.from_camera[static_cast<std::size_t>(i)]; }
    double light(int i) const { return densities.from_light[static_cast<std::size_t>(i)]; }
    bool is_delta(int i) const { return densities.is_delta[static_cast<std::size_t>(i)] != 0; }
};

inline bool is_possible(const WeighedPath& path, Technique t) {
    switch (t.kind) {
        case TechniqueKind::Hit:
            return true;
        case TechniqueKind::NextEvent:
            return !path.is_delta(path.n() - 1);
        case TechniqueKind::Light:
            return !path.is_delta(1);
        case TechniqueKind::Connect:
            return !path.is_delta(t.k) && !path.is_delta(t.k + 1);
        case TechniqueKind::Merge:
            return !path.is_delta(t.k) && (t.k > 1 || path.counts.merge_first);
    }
    return false;
}

// q_t by its row of the table.
inline LongProduct by_the_table(const WeighedPath& path, Technique t) {
    LongProduct q;
    if (path.n() == 1) return q;
    if (!is_possible(path, t)) {
        q.multiply(0);
        return q;
    }
    int last_of_camera = t.k;        // ∏ C_1 … of it
    int first_of_light = t.k + 1;    // ∏ of it … L_n
    bool has_own_second = t.k >= 2;  // beside the other paths that share x_1
    switch (t.kind) {
        case TechniqueKind::Hit:
            last_of_camera = path.n();
            first_of_light = path.n() + 1;
            has_own_second = true;
            q.multiply(path.counts.hit);
            break;
        case TechniqueKind::NextEvent:
            last_of_camera = path.n() - 1;
            first_of_light = path.n() + 1;
            has_own_second = path.n() > 2;
            q.multiply(path.counts.nee);
            q.multiply(path.densities.next_event);
            break;
        case TechniqueKind::Light:
            q.multiply(path.counts.light);
            break;
        case TechniqueKind::Connect:
            q.multiply(path.counts.connect);
            break;
        case TechniqueKind::Merge:
            first_of_light = t.k;
            q.multiply(path.counts.merge);
            q.multiply(path.densities.merge_area);
            break;
    }
    if (has_own_second) q.multiply(path.counts.split);
    for (int i = 1; i <= last_of_camera; ++i) q.multiply(path.camera(i));
    for (int i = first_of_light; i <= path.n(); ++i) q.multiply(path.light(i));
    return q;
}

}  // namespace misbench::test
