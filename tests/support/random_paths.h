// Densities of full paths and numbers of samples, by fixed seeds.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "tests/support/technique_table.h"

namespace misbench::test {

class RandomPaths {
 public:
    explicit RandomPaths(unsigned seed) : rng_(seed) {}

    bool chance(double p) { return std::bernoulli_distribution(p)(rng_); }
    // Uniform in the logarithm over that many decades on either side of 1.
    double magnitude(double decades) {
        return std::pow(10, std::uniform_real_distribution<double>(-decades, decades)(rng_));
    }
    WeighedPath path(int n, double decades, double zeros = 0, double deltas = 0) {
        WeighedPath path;
        path.densities.make_room(n);
        path.densities.n_edges = n;
        for (std::size_t i = 1; i <= static_cast<std::size_t>(n); ++i) {
            path.densities.from_camera[i] = chance(zeros) ? 0 : magnitude(decades);
            path.densities.from_light[i] = chance(zeros) ? 0 : magnitude(decades);
            path.densities.is_delta[i] = i < static_cast<std::size_t>(n) && chance(deltas);
        }
        path.densities.next_event = chance(zeros) ? 0 : magnitude(decades);
        path.densities.merge_area = magnitude(3);
        // Read by mistake, these would be seen.
        path.densities.from_camera[0] = path.densities.from_light[0] =
            std::numeric_limits<double>::infinity();
        path.densities.is_delta[0] = 1;
        return path;
    }
    TechniqueCounts counts() {
        TechniqueCounts counts;
        const auto count = [this] { return chance(0.2) ? 0 : magnitude(4); };
        if (chance(0.2)) {
            // Only one technique.
            const std::array all = {&TechniqueCounts::hit, &TechniqueCounts::nee,
                                    &TechniqueCounts::light, &TechniqueCounts::connect,
                                    &TechniqueCounts::merge};
            for (const auto member : all) counts.*member = 0;
            counts.*all[rng_() % all.size()] = magnitude(4);
        } else {
            counts.hit = chance(0.2) ? 0 : 1;
            counts.nee = count();
            counts.light = count();
            counts.connect = count();
            counts.merge = count();
        }
        if (chance(0.5)) counts.split = 1 + static_cast<double>(rng_() % 8);
        counts.merge_first = chance(0.5);
        return counts;
    }
    std::vector<double> factors(int n, double decades) {
        std::vector<double> factors(static_cast<std::size_t>(n));
        for (double& factor : factors) factor = magnitude(decades);
        return factors;
    }

 private:
    std::mt19937_64 rng_;
};

}  // namespace misbench::test
