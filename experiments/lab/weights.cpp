#include "experiments/lab/weights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "experiments/lab/quadrature.h"
#include "renderer/base/check.h"
#include "renderer/mis/factors.h"
#include "renderer/mis/heuristics.h"
#include "renderer/mis/optimal_weights.h"

namespace misbench::lab {
namespace {

Weigh with_factors(const Heuristic& heuristic, std::vector<double> factors) {
    return [heuristic, factors = std::move(factors)](
               double /*x*/, double f, std::span<const double> q, std::span<double> weighted) {
        std::ranges::copy(q, weighted.begin());
        if (std::ranges::all_of(q, [](double q_t) { return q_t == 0; })) return;
        heuristic.shares(weighted);
        double sum = 0;
        for (std::size_t t = 0; t < q.size(); ++t) sum += weighted[t] *= factors[t];
        // Not a number where all that could sample this place have the factor 0: there are no such
        // weights, and a search that took 0 for them would find the estimator that is always 0.
        for (double& u : weighted) u = f == 0 ? 0 : u / sum * f;
    };
}

std::vector<Sample> draw_pilot(const Problem& problem, std::int64_t seed, int iteration) {
    Rng rng(seed, kPilotRun, static_cast<std::uint32_t>(iteration));
    return draw(problem, rng);
}

// Of technique t alone, from a pilot: the mean and variance over its draws, and the mean of
// Σ_i (f / (n p))².
TechniqueMoments pilot_technique_moments(const Problem& problem, std::size_t technique, int n_draws,
                                         std::int64_t seed) {
    std::vector<double> estimates;
    double second_moment = 0;
    for (int i = 0; i < n_draws; ++i) {
        double sum = 0;
        for (const Sample& sample : draw_pilot(problem, seed, i)) {
            if (sample.technique != technique) continue;
            const double value = problem.integrand.value(sample.x) /
                                 problem.techniques[technique].effective_density(sample.x);
            sum += value;
            second_moment += value * value / n_draws;
        }
        estimates.push_back(sum);
    }
    const double mean = std::accumulate(estimates.begin(), estimates.end(), 0.0) / n_draws;
    double variance = 0;
    for (const double e : estimates) variance += (e - mean) * (e - mean) / (n_draws - 1);
    return {{.mean = mean, .variance = variance}, second_moment};
}

std::vector<TechniqueMoments> technique_moments(const Problem& problem, const MomentsFrom& from,
                                                std::int64_t seed) {
    std::vector<TechniqueMoments> moments;
    for (std::size_t t = 0; t < problem.techniques.size(); ++t) {
        moments.push_back(from.pilot ? pilot_technique_moments(problem, t, *from.pilot, seed)
                                     : exact_technique_moments(problem, t));
    }
    return moments;
}

// 1 / σ_t² in units of the largest, so that a technique without variance has all the weight.
std::vector<double> inverse_variances(const std::vector<TechniqueMoments>& techniques) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [moments, second] : techniques) least = std::min(least, moments.variance);
    std::vector<double> factors;
    for (const auto& [moments, second] : techniques) {
        factors.push_back(moments.variance == least ? 1 : least / moments.variance);
    }
    return factors;
}

std::vector<double> heuristic_factors(const Problem& problem, const HeuristicWeights& weights,
                                      std::int64_t seed) {
    std::vector<double> factors(problem.techniques.size(), 1.0);
    if (weights.inverse_variance) {
        factors = inverse_variances(technique_moments(problem, *weights.inverse_variance, seed));
    }
    if (weights.variance) {
        const auto moments = technique_moments(problem, *weights.variance, seed);
        for (std::size_t t = 0; t < factors.size(); ++t) {
            factors[t] *=
                variance_factor(moments[t].independent_second_moment, moments[t].moments.variance);
        }
    }
    for (std::size_t t = 0; weights.popov && t < factors.size(); ++t) {
        const Technique& technique = problem.techniques[t];
        if (technique.layout == Layout::Shared) factors[t] /= technique.samples;
    }
    return factors;
}

// Every combination of the grid's factors times `before`; the unchanged one first.
std::vector<std::vector<double>> combinations(const Problem& problem, const CandidateGrid& grid,
                                              const std::vector<double>& before) {
    std::vector<std::vector<double>> all{before};
    std::vector<std::vector<double>> some{before};
    for (std::size_t t = 0; t < before.size(); ++t) {
        if (std::ranges::find(grid.fixed, problem.techniques[t].name) != grid.fixed.end()) continue;
        std::vector<std::vector<double>> next;
        for (const auto& factors : some) {
            for (int c = 0; c < grid.candidates; ++c) {
                next.push_back(factors);
                next.back()[t] *= std::lerp(grid.low, grid.high, c / (grid.candidates - 1.0));
            }
        }
        some = std::move(next);
    }
    all.insert(all.end(), some.begin(), some.end());
    return all;
}

// M_γ of the estimator with these factors: hua2025 Eq. 21, or Eq. 23 from a pilot.
double moment_of(const Problem& problem, const Weigh& weigh, const MomentsFrom& from,
                 std::int64_t seed) {
    if (!from.pilot) return exact_moments(problem, weigh).second_moment();
    double moment = 0;
    for (int i = 0; i < *from.pilot; ++i) {
        const double value = estimate(problem, weigh, draw_pilot(problem, seed, i));
        moment += value * value / *from.pilot;
    }
    return moment;
}

std::vector<double> corrected(const Problem& problem, const Heuristic& heuristic,
                              const CandidateGrid& grid, const std::vector<double>& before,
                              std::int64_t seed) {
    const std::vector<std::vector<double>> candidates = combinations(problem, grid, before);
    std::vector<double> moments;
    for (const std::vector<double>& factors : candidates) {
        moments.push_back(moment_of(problem, with_factors(heuristic, factors), grid.moments, seed));
    }
    return candidates[best_candidate(moments, 0)];
}

FixedWeights fix(const Problem& problem, const HeuristicWeights& weights, std::int64_t seed) {
    const Heuristic heuristic = Heuristic::parse(weights.heuristic);
    std::vector<double> factors = heuristic_factors(problem, weights, seed);
    if (weights.correction) {
        factors = corrected(problem, heuristic, *weights.correction, factors, seed);
    }
    return {with_factors(heuristic, factors), factors};
}

// α of the optimal weights by quadrature.
std::vector<double> exact_alpha(const Problem& problem, const IndependentTechniques& techniques) {
    const std::size_t n = techniques.counts().size();
    const std::size_t n_entries = n * (n + 1) / 2;
    std::vector<double> q(problem.techniques.size());
    std::vector<double> apart(n);
    const Integrals integrals = integrate(
        [&](double x, std::span<double> values) {
            problem.effective_densities(x, q);
            techniques.densities(x, q, apart);
            const double f = problem.integrand.value(x);
            const double sum = std::accumulate(apart.begin(), apart.end(), 0.0);
            std::size_t entry = 0;
            for (std::size_t i = 0; i < n; ++i) {
                for (std::size_t k = 0; k <= i; ++k) {
                    values[entry++] = sum > 0 ? apart[i] * apart[k] / sum : 0;
                }
                values[n_entries + i] = sum > 0 ? f * apart[i] / sum : 0;
            }
        },
        n_entries + n, problem.edges());
    MISBENCH_CHECK(integrals.converged);  // all are bounded by f and the densities
    std::vector<double> totals;
    for (std::size_t j = 0; j < n_entries + n; ++j) totals.push_back(integrals.total(j));
    return solve_for_optimal(std::span(totals).first(n_entries), std::span(totals).last(n));
}

FixedWeights fix_optimal(const Problem& problem) {
    const IndependentTechniques techniques(problem);
    const std::vector<double> alpha = exact_alpha(problem, techniques);
    const Weigh weigh = [=](double x, double f, std::span<const double> q,
                            std::span<double> weighted) {
        std::ranges::fill(weighted, 0.0);
        if (std::ranges::all_of(q, [](double q_t) { return q_t == 0; })) return;
        std::vector<double> apart(alpha.size());
        std::vector<double> weighted_apart(alpha.size());
        techniques.densities(x, q, apart);
        weigh_optimally(apart, f, alpha, weighted_apart);
        for (std::size_t t = 0; t < q.size(); ++t) {
            weighted[t] = weighted_apart[techniques.index(t, x)];
        }
    };
    return {weigh, {}};
}

}  // namespace

std::optional<std::vector<double>> weights_at(const Problem& problem, const FixedWeights& weights,
                                              double x) {
    const double f = problem.integrand.value(x);
    if (f == 0) return std::nullopt;
    std::vector<double> q(problem.techniques.size());
    std::vector<double> weighted(q.size());
    problem.effective_densities(x, q);
    weights.weigh(x, f, q, weighted);
    for (double& w : weighted) w /= f;
    return weighted;
}

IndependentTechniques::IndependentTechniques(const Problem& problem) : problem_(problem) {
    for (const Technique& technique : problem.techniques) {
        first_.push_back(counts_.size());
        const bool is_stratified = technique.layout == Layout::Stratified;
        counts_.insert(counts_.end(), is_stratified ? technique.n_cells() : 1,
                       is_stratified ? 1 : technique.samples);
    }
}

std::size_t IndependentTechniques::index(std::size_t technique, double x) const {
    const Technique& at = problem_.techniques[technique];
    return first_[technique] + (at.layout == Layout::Stratified ? at.cell_of(x) : 0);
}

void IndependentTechniques::densities(double x, std::span<const double> q,
                                      std::span<double> apart) const {
    std::ranges::fill(apart, 0.0);
    for (std::size_t t = 0; t < q.size(); ++t) apart[index(t, x)] = q[t];
}

std::optional<FixedWeights> fix_weights(const Problem& problem, const Weighting& weighting,
                                        std::int64_t seed) {
    if (const auto* weights = std::get_if<HeuristicWeights>(&weighting.kind)) {
        return fix(problem, *weights, seed);
    }
    if (const auto* one = std::get_if<OneTechnique>(&weighting.kind)) {
        return FixedWeights{only_technique(problem.index_of(one->technique)), {}};
    }
    const auto& optimal = std::get<OptimalWeights>(weighting.kind);
    if (optimal.how != OptimalWeights::How::Exact) return std::nullopt;
    return fix_optimal(problem);
}

}  // namespace misbench::lab
