// The optimal weights of multiple importance sampling, estimated with the samples that they weigh.
// Mathematics on densities, like heuristics.h: one sample is the effective densities
// q_k = n_k p_k(x) of all techniques and the value f(x). Weights may be negative, samples must be
// independent, and every sample counts with its true densities, also where f is 0: one that is left
// out makes the estimate wrong, not only noisy.
//
// [KVG*19]  I. Kondapaneni, P. Vévoda, P. Grittmann, T. Skřivan, P. Slusallek, J. Křivánek, Optimal
//           Multiple Importance Sampling, 2019.
//
// alpha  coefficients of the control variate Σ_k α_k q_k ≈ f, one a technique. [KVG*19] has
//        n_k α_k, coefficients of the p_k; these here are of better condition when counts differ.
// A, b   A_ik = ∫ q_i q_k / Σq dx, b_i = ∫ f q_i / Σq dx; optimal is A α = b
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace misbench {

// The α of least norm among those of least error: densities that depend on each other or a
// technique that was never hit make A singular. `matrix` is the lower triangle of A, row by row.
std::vector<double> solve_for_optimal(std::span<const double> matrix, std::span<const double> rhs);

// w_i(x) f(x) of all techniques, which is finite where f is 0 and w_i is not.
void weigh_optimally(std::span<const double> q, double f, std::span<const double> alpha,
                     std::span<double> weighted);

// A and b from samples.
class OptimalSystem {
 public:
    explicit OptimalSystem(std::size_t n_techniques);
    // REQUIRES: some q_k > 0.
    void add(std::span<const double> q, double f);
    // All 0, which stands for the balance heuristic, while there are fewer samples than techniques.
    std::vector<double> solve() const;
    std::size_t n_samples() const { return n_samples_; }

 private:
    std::vector<double> matrix_;
    std::vector<double> rhs_;
    std::size_t n_samples_ = 0;
};

// Both estimators see iterations, each with n_k samples of every technique k. `counts` are the n_k.

// Solves once, with the very samples: consistent, but biased when they are few.
class DirectEstimator {
 public:
    explicit DirectEstimator(std::vector<double> counts);
    void add(std::span<const double> q, double f);
    void end_iteration() { ++n_iterations_; }
    double estimate() const;

 private:
    std::vector<double> counts_;
    OptimalSystem system_;
    double balance_sum_ = 0;
    std::int64_t n_iterations_ = 0;
};

// Weighs an iteration with what earlier ones say, hence unbiased. It starts with the balance
// heuristic, until there are twice as many samples as techniques: with hardly more samples than
// unknowns, α follows the samples exactly and may be of any size, and a few such runs can hold all
// of the variance.
class ProgressiveEstimator {
 public:
    explicit ProgressiveEstimator(std::vector<double> counts);
    void add(std::span<const double> q, double f);
    void end_iteration();
    double estimate() const;

 private:
    std::vector<double> counts_;
    OptimalSystem system_;
    std::vector<double> alpha_;
    double sum_ = 0;
    std::int64_t n_iterations_ = 0;
};

}  // namespace misbench
