// An integral on an interval and the techniques that sample it: where a weight can be tried before
// anything is rendered, because all about it can be computed.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "experiments/lab/curve.h"
#include "renderer/base/rng.h"

namespace misbench::lab {

// How the samples of a technique belong together. Whatever it is, each sample has the technique's
// density, and techniques are independent of each other.
enum class Layout {
    Independent,
    // One sample in each of n strata of equal probability.
    Stratified,
    // The interval is cut in m cells of equal probability. One cell is chosen for all n samples,
    // which are then independent inside it: as the suffixes of paths that share a prefix. One cell
    // is independence, many are n copies of one sample.
    Shared,
};

struct Technique {
    std::string name;
    Density density;  // 0 in places where the integrand is not: the technique alone is biased
    int samples = 1;
    Layout layout = Layout::Independent;
    std::vector<double>
        cells;  // edges of strata or cells, the interval's ends where there are none

    double effective_density(double x) const { return samples * density.value(x); }
    std::size_t n_cells() const { return cells.size() - 1; }
    std::size_t cell_of(double x) const;
};

// `n_cells` is for Layout::Shared only.
Technique make_technique(std::string name, Density density, int samples, Layout layout,
                         int n_cells);

struct Problem {
    std::string name;
    std::string description;
    Domain domain;
    Curve integrand;
    std::vector<Technique> techniques;

    double integral() const { return integrand.integral_to(domain.high); }
    // REQUIRES: there is one of that name.
    std::size_t index_of(const std::string& technique) const;
    void effective_densities(double x, std::span<double> q) const;
    // Of integrand, densities and cells: between two of them everything but a weight is smooth.
    std::vector<double> edges() const;
};

struct Sample {
    std::size_t technique;
    double x;
};

// All samples of all techniques, once.
std::vector<Sample> draw(const Problem& problem, Rng& rng);

}  // namespace misbench::lab
