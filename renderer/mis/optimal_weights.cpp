#include "renderer/mis/optimal_weights.h"

#include <Eigen/Dense>
#include <algorithm>
#include <numeric>
#include <utility>

#include "renderer/base/check.h"

namespace misbench {
namespace {

// Below this part of the largest one a pivot is rounding, not information.
constexpr double kRankThreshold = 1e-10;

constexpr std::size_t kSamplesPerTechnique = 2;

double sum_of(std::span<const double> values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

double dot(std::span<const double> a, std::span<const double> b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

// (f - Σ_k α_k q_k) / Σ_k q_k: what the control variate leaves of a sample.
double remainder(std::span<const double> q, double f, std::span<const double> alpha) {
    return (f - dot(alpha, q)) / sum_of(q);
}

}  // namespace

std::vector<double> solve_for_optimal(std::span<const double> matrix, std::span<const double> rhs) {
    const auto n = static_cast<Eigen::Index>(rhs.size());
    MISBENCH_CHECK(matrix.size() == rhs.size() * (rhs.size() + 1) / 2);
    if (std::ranges::all_of(rhs, [](double b) { return b == 0; })) {
        return std::vector<double>(rhs.size(), 0.0);
    }
    Eigen::MatrixXd a(n, n);
    auto entry = matrix.begin();
    for (Eigen::Index i = 0; i < n; ++i) {
        for (Eigen::Index k = 0; k <= i; ++k) a(i, k) = a(k, i) = *entry++;
    }
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition(n, n);
    decomposition.setThreshold(kRankThreshold);
    decomposition.compute(a);
    const Eigen::VectorXd alpha =
        decomposition.solve(Eigen::Map<const Eigen::VectorXd>(rhs.data(), n));
    return {alpha.begin(), alpha.end()};
}

void weigh_optimally(std::span<const double> q, double f, std::span<const double> alpha,
                     std::span<double> weighted) {
    const double rest = remainder(q, f, alpha);
    for (std::size_t i = 0; i < q.size(); ++i) weighted[i] = q[i] * (alpha[i] + rest);
}

OptimalSystem::OptimalSystem(std::size_t n_techniques)
    : matrix_(n_techniques * (n_techniques + 1) / 2), rhs_(n_techniques) {}

// Samples of all techniques have density Σq together, so that a mean over them divides by it.
void OptimalSystem::add(std::span<const double> q, double f) {
    const double sum = sum_of(q);
    MISBENCH_CHECK(sum > 0);
    auto entry = matrix_.begin();
    for (std::size_t i = 0; i < q.size(); ++i) {
        for (std::size_t k = 0; k <= i; ++k) *entry++ += (q[i] / sum) * (q[k] / sum);
        rhs_[i] += (q[i] / sum) * (f / sum);
    }
    ++n_samples_;
}

std::vector<double> OptimalSystem::solve() const {
    if (n_samples_ < rhs_.size()) return std::vector<double>(rhs_.size(), 0.0);
    return solve_for_optimal(matrix_, rhs_);
}

DirectEstimator::DirectEstimator(std::vector<double> counts)
    : counts_(std::move(counts)), system_(counts_.size()) {}

void DirectEstimator::add(std::span<const double> q, double f) {
    system_.add(q, f);
    balance_sum_ += f / sum_of(q);
}

double DirectEstimator::estimate() const {
    if (system_.n_samples() < counts_.size())
        return balance_sum_ / static_cast<double>(n_iterations_);
    return dot(counts_, system_.solve());
}

ProgressiveEstimator::ProgressiveEstimator(std::vector<double> counts)
    : counts_(std::move(counts)), system_(counts_.size()), alpha_(counts_.size()) {}

void ProgressiveEstimator::add(std::span<const double> q, double f) {
    sum_ += remainder(q, f, alpha_);
    system_.add(q, f);
}

void ProgressiveEstimator::end_iteration() {
    sum_ += dot(counts_, alpha_);
    if (system_.n_samples() >= kSamplesPerTechnique * counts_.size()) alpha_ = system_.solve();
    ++n_iterations_;
}

double ProgressiveEstimator::estimate() const { return sum_ / static_cast<double>(n_iterations_); }

}  // namespace misbench
