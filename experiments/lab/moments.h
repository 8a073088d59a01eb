// What a combined estimator is exactly, without a sample: its mean, and its variance with all that
// the layout of the samples does to it.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "experiments/lab/problem.h"

namespace misbench::lab {

// w_t(x) f(x) of every technique t, from the effective densities at x. The product, because optimal
// weights have one that is finite where f is 0. 0 where no density is above 0.
using Weigh =
    std::function<void(double x, double f, std::span<const double> q, std::span<double> weighted)>;

struct Moments {
    double mean = 0;
    double variance = 0;  // infinite where the quadrature finds no end
    double error = 0;     // bound on the quadrature's error of the variance

    double second_moment() const { return variance + mean * mean; }
};

// Of Σ_t Σ_i w_t(x_ti) f(x_ti) / (n_t p_t(x_ti)).
Moments exact_moments(const Problem& problem, const Weigh& weigh);

// One value of that estimator.
double estimate(const Problem& problem, const Weigh& weigh, std::span<const Sample> samples);

// Technique t alone, with what grittmann2019 Eq. 7 divides by its variance: the second moment
// ∫ f² / (n_t p_t) dx as if its samples were independent.
struct TechniqueMoments {
    Moments moments;
    double independent_second_moment = 0;
};
TechniqueMoments exact_technique_moments(const Problem& problem, std::size_t technique);
// The weight of technique t alone: 1, and 0 of all others.
Weigh only_technique(std::size_t technique);

}  // namespace misbench::lab
