// [Vea97]  E. Veach, Robust Monte Carlo Methods for Light Transport Simulation, 1997.
//
// h      w_t f of a technique t, with n samples of density p
// H_c    ∫ h dx over cell c of the technique
// S      ∫ h² / (n p) dx
#include "experiments/lab/moments.h"

#include <cmath>
#include <limits>
#include <vector>

#include "experiments/lab/quadrature.h"

namespace misbench::lab {
namespace {

// What the integrals of h over the cells take from S. With one cell, and for independent samples,
// it is the second term of the variance in [Vea97] chapter 9.
double subtracted(const Technique& technique, std::span<const double> cells) {
    const double n = technique.samples;
    double sum = 0;
    double sum_of_squares = 0;
    for (const double h : cells) {
        sum += h;
        sum_of_squares += h * h;
    }
    switch (technique.layout) {
        case Layout::Independent:
            return sum * sum / n;
        // n estimators of one sample with density n p: each subtracts its own mean.
        case Layout::Stratified:
            return sum_of_squares;
        // The mean of the variance given the cell, (S n - m Σ H_c²) / n, and the variance of the
        // mean given the cell, m Σ H_c² - (Σ H_c)².
        case Layout::Shared: {
            const auto m = static_cast<double>(technique.n_cells());
            return sum * sum - m * sum_of_squares * (1 - 1 / n);
        }
    }
    return std::numeric_limits<double>::quiet_NaN();
}

// Of a sum over some hundred pieces.
constexpr double kRounding = 1e-14;

// The integrals of h over the cells of technique t, function t of `integrals`.
std::vector<double> cell_integrals(const Technique& technique, const Integrals& integrals,
                                   std::span<const double> edges, std::size_t t) {
    std::vector<double> cells(technique.n_cells());
    for (std::size_t i = 0; i < integrals.pieces.size(); ++i) {
        cells[technique.cell_of(0.5 * (edges[i] + edges[i + 1]))] += integrals.pieces[i][t];
    }
    return cells;
}

}  // namespace

Moments exact_moments(const Problem& problem, const Weigh& weigh) {
    const std::size_t n = problem.techniques.size();
    std::vector<double> q(n);
    std::vector<double> h(n);
    const std::vector<double> edges = problem.edges();
    const Integrals integrals = integrate(
        [&](double x, std::span<double> values) {
            problem.effective_densities(x, q);
            weigh(x, problem.integrand.value(x), q, h);
            for (std::size_t t = 0; t < n; ++t) {
                values[t] = q[t] > 0 ? h[t] : 0;
                values[n + t] = q[t] > 0 ? h[t] * h[t] / q[t] : 0;
            }
        },
        2 * n, edges);

    Moments moments;
    for (std::size_t t = 0; t < n; ++t) {
        const std::vector<double> cells =
            cell_integrals(problem.techniques[t], integrals, edges, t);
        const double mean = integrals.total(t);
        moments.mean += mean;
        moments.variance += integrals.total(n + t) - subtracted(problem.techniques[t], cells);
        moments.error += integrals.errors[n + t] + 2 * std::abs(mean) * integrals.errors[t] +
                         kRounding * integrals.total(n + t);
    }
    if (!integrals.converged) moments.variance = std::numeric_limits<double>::infinity();
    // A difference of equal numbers may be below 0 by its rounding.
    if (std::abs(moments.variance) <= moments.error) moments.variance = 0;
    return moments;
}

double estimate(const Problem& problem, const Weigh& weigh, std::span<const Sample> samples) {
    std::vector<double> q(problem.techniques.size());
    std::vector<double> h(problem.techniques.size());
    double sum = 0;
    for (const Sample& sample : samples) {
        problem.effective_densities(sample.x, q);
        weigh(sample.x, problem.integrand.value(sample.x), q, h);
        sum += h[sample.technique] / q[sample.technique];
    }
    return sum;
}

TechniqueMoments exact_technique_moments(const Problem& problem, std::size_t technique) {
    const auto f_squared_over_q = [&](double x, std::span<double> values) {
        const double f = problem.integrand.value(x);
        const double q = problem.techniques[technique].effective_density(x);
        values[0] = q > 0 ? f * f / q : 0;
    };
    const Integrals integrals = integrate(f_squared_over_q, 1, problem.edges());
    return {exact_moments(problem, only_technique(technique)),
            integrals.converged ? integrals.total(0) : std::numeric_limits<double>::infinity()};
}

Weigh only_technique(std::size_t technique) {
    return
        [technique](double /*x*/, double f, std::span<const double> q, std::span<double> weighted) {
            for (std::size_t t = 0; t < q.size(); ++t) {
                weighted[t] = t == technique && q[t] > 0 ? f : 0;
            }
        };
}

}  // namespace misbench::lab
