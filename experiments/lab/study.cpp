#include "experiments/lab/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

#include "renderer/base/check.h"
#include "renderer/mis/optimal_weights.h"

namespace misbench::lab {
namespace {

int iterations_of(const Weighting& weighting) {
    const auto* optimal = std::get_if<OptimalWeights>(&weighting.kind);
    return optimal == nullptr ? 1 : optimal->iterations;
}

// One estimate with an estimator of optimal_weights.h, from this run's draws.
template <typename Estimator>
double run_estimator(const Problem& problem, const IndependentTechniques& techniques,
                     std::int64_t seed, std::uint32_t run, int iterations) {
    Estimator estimator(techniques.counts());
    std::vector<double> q(problem.techniques.size());
    std::vector<double> apart(techniques.counts().size());
    for (int i = 0; i < iterations; ++i) {
        Rng rng(seed, run, static_cast<std::uint32_t>(i));
        for (const Sample& sample : draw(problem, rng)) {
            problem.effective_densities(sample.x, q);
            techniques.densities(sample.x, q, apart);
            estimator.add(apart, problem.integrand.value(sample.x));
        }
        estimator.end_iteration();
    }
    return estimator.estimate();
}

// The mean of values, and n / (n - 1) times the mean of their squared deviations.
void summarize(const std::vector<double>& estimates, double integral, int iterations,
               Outcome& outcome) {
    const auto n = static_cast<double>(estimates.size());
    const double mean = std::accumulate(estimates.begin(), estimates.end(), 0.0) / n;
    std::vector<double> deviations;
    std::vector<double> squares;
    for (const double e : estimates) {
        deviations.push_back(e - integral);
        squares.push_back((e - mean) * (e - mean) * iterations * n / (n - 1));
    }
    outcome.sampled_bias = estimate_mean(deviations);
    outcome.sampled_variance = estimate_mean(squares);
}

std::optional<double> error_of(const Outcome& outcome, double integral, int iterations) {
    if (outcome.exact) {
        const double bias = outcome.exact->mean - integral;
        return outcome.exact->variance + bias * bias;
    }
    if (!outcome.sampled_variance) return std::nullopt;
    const double bias = outcome.sampled_bias->value;
    return outcome.sampled_variance->value + iterations * bias * bias;
}

class Judge {
 public:
    Judge(const Case& of, const CaseOutcome& outcome) : case_(of), outcome_(outcome) {}

    Verdict operator()(const LessError& test) const {
        const std::optional<double> less = error(test.less);
        const std::optional<double> more = error(test.more);
        if (!less || !more) return {false, "not sampled"};
        const bool holds = test.factor * *less < *more;
        return {holds,
                fmt::format("errors {:.4g} and {:.4g}, ratio {:.3g}", *less, *more, *more / *less)};
    }
    Verdict operator()(const EqualError& test) const {
        const std::optional<double> a = error(test.a);
        const std::optional<double> b = error(test.b);
        if (!a || !b) return {false, "not sampled"};
        return {std::abs(*a - *b) <= test.within * *b,
                fmt::format("errors {:.6g} and {:.6g}, ratio {:.3g}", *a, *b, *a / *b)};
    }
    Verdict operator()(const LessWeight& test) const {
        const double less = weight(test.less, test.technique, test.at);
        const double more = weight(test.more, test.technique, test.at);
        return {less < more, fmt::format("weights {:.3g} and {:.3g}", less, more)};
    }
    Verdict operator()(const NegativeWeight& test) const {
        const Domain& domain = case_.problem.domain;
        double least = 0;
        for (int i = 0; i < kPoints; ++i) {
            const double x = std::lerp(domain.low, domain.high, (i + 0.5) / kPoints);
            const auto weights = weights_at(case_.problem, *find(test.weighting).weights, x);
            if (weights) least = std::min(least, *std::ranges::min_element(*weights));
        }
        return {least < -kRounding, fmt::format("least weight {:.3g}", least)};
    }

 private:
    static constexpr int kPoints = 1000;
    static constexpr double kRounding = 1e-9;

    const Outcome& find(const std::string& weighting) const {
        const auto found = std::ranges::find(case_.weightings, weighting, &Weighting::name);
        MISBENCH_CHECK(found != case_.weightings.end());
        return outcome_
            .outcomes[static_cast<std::size_t>(std::distance(case_.weightings.begin(), found))];
    }
    std::optional<double> error(const std::string& weighting) const {
        return find(weighting).error;
    }
    double weight(const std::string& weighting, const std::string& technique, double x) const {
        const auto weights = weights_at(case_.problem, *find(weighting).weights, x);
        return weights ? (*weights)[case_.problem.index_of(technique)]
                       : std::numeric_limits<double>::quiet_NaN();
    }

    const Case& case_;
    const CaseOutcome& outcome_;
};

}  // namespace

std::vector<double> sample_estimates(const Problem& problem, const Weighting& weighting,
                                     const std::optional<FixedWeights>& weights, std::int64_t seed,
                                     int runs) {
    const IndependentTechniques techniques(problem);
    std::vector<double> estimates;
    for (std::uint32_t run = 0; run < static_cast<std::uint32_t>(runs); ++run) {
        if (weights) {
            Rng rng(seed, run, 0);
            estimates.push_back(estimate(problem, weights->weigh, draw(problem, rng)));
            continue;
        }
        const auto& optimal = std::get<OptimalWeights>(weighting.kind);
        const auto run_once = optimal.how == OptimalWeights::How::Direct
                                  ? run_estimator<DirectEstimator>
                                  : run_estimator<ProgressiveEstimator>;
        estimates.push_back(run_once(problem, techniques, seed, run, optimal.iterations));
    }
    return estimates;
}

CaseOutcome examine(const Case& of, std::int64_t seed, int runs) {
    CaseOutcome result;
    result.integral = of.problem.integral();
    const Moments balance =
        exact_moments(of.problem, fix_weights(of.problem, {"", HeuristicWeights{}}, seed)->weigh);
    const double balance_bias = balance.mean - result.integral;
    const double balance_error = balance.variance + balance_bias * balance_bias;
    for (const Weighting& weighting : of.weightings) {
        Outcome outcome;
        outcome.weights = fix_weights(of.problem, weighting, seed);
        if (outcome.weights) outcome.exact = exact_moments(of.problem, outcome.weights->weigh);
        if (runs > 0) {
            summarize(sample_estimates(of.problem, weighting, outcome.weights, seed, runs),
                      result.integral, iterations_of(weighting), outcome);
        }
        outcome.error = error_of(outcome, result.integral, iterations_of(weighting));
        if (outcome.error && balance_error > 0 && std::isfinite(balance_error)) {
            outcome.error_ratio = *outcome.error / balance_error;
        }
        result.outcomes.push_back(std::move(outcome));
    }
    for (const Expectation& expectation : of.expectations) {
        result.verdicts.push_back(std::visit(Judge(of, result), expectation.test));
    }
    return result;
}

}  // namespace misbench::lab
