#include "experiments/lab/problem.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "renderer/base/check.h"

namespace misbench::lab {
namespace {

// 48 random bits, never 0 or 1: a float's 24 are too few for a tail.
double uniform(Rng& rng) {
    const double high = static_cast<double>(rng.uniform());
    const double low = static_cast<double>(rng.uniform());
    return high + (low + 0x1p-25) * 0x1p-24;
}

void draw_technique(const Technique& technique, std::size_t index, Rng& rng,
                    std::vector<Sample>& samples) {
    const auto n_cells = static_cast<double>(technique.n_cells());
    double cell = technique.layout == Layout::Shared ? std::floor(uniform(rng) * n_cells) : 0;
    for (int i = 0; i < technique.samples; ++i) {
        if (technique.layout == Layout::Stratified) cell = i;
        samples.push_back({index, technique.density.quantile((cell + uniform(rng)) / n_cells)});
    }
}

}  // namespace

std::size_t Technique::cell_of(double x) const {
    const auto above = std::upper_bound(cells.begin() + 1, cells.end() - 1, x);
    return static_cast<std::size_t>(std::distance(cells.begin(), above)) - 1;
}

Technique make_technique(std::string name, Density density, int samples, Layout layout,
                         int n_cells) {
    if (layout != Layout::Shared) n_cells = layout == Layout::Stratified ? samples : 1;
    std::vector<double> cells{density.edges().front()};
    for (int i = 1; i < n_cells; ++i) {
        cells.push_back(density.quantile(static_cast<double>(i) / n_cells));
    }
    cells.push_back(density.edges().back());
    return {std::move(name), std::move(density), samples, layout, std::move(cells)};
}

std::size_t Problem::index_of(const std::string& technique) const {
    const auto found = std::ranges::find(techniques, technique, &Technique::name);
    MISBENCH_CHECK(found != techniques.end());
    return static_cast<std::size_t>(std::distance(techniques.begin(), found));
}

void Problem::effective_densities(double x, std::span<double> q) const {
    for (std::size_t t = 0; t < techniques.size(); ++t) q[t] = techniques[t].effective_density(x);
}

std::vector<double> Problem::edges() const {
    std::vector<double> edges(integrand.edges().begin(), integrand.edges().end());
    for (const Technique& technique : techniques) {
        const std::span<const double> of_density = technique.density.edges();
        edges.insert(edges.end(), of_density.begin(), of_density.end());
        edges.insert(edges.end(), technique.cells.begin(), technique.cells.end());
    }
    std::ranges::sort(edges);
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return edges;
}

std::vector<Sample> draw(const Problem& problem, Rng& rng) {
    std::vector<Sample> samples;
    for (std::size_t t = 0; t < problem.techniques.size(); ++t) {
        draw_technique(problem.techniques[t], t, rng, samples);
    }
    return samples;
}

}  // namespace misbench::lab
