#include "experiments/statistics/convergence_fit.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "renderer/base/check.h"

namespace misbench {
namespace {

bool is_above_zero(std::span<const double> values) {
    return std::ranges::all_of(values, [](double value) { return value > 0; });
}

std::vector<double> logarithms(std::span<const double> values) {
    std::vector<double> logs;
    for (const double value : values) logs.push_back(std::log(value));
    return logs;
}

// y = intercept + slope x by weighted least squares; all weights above 0, two different x at least.
struct Line {
    double intercept = 0;
    double slope = 0;
};
Line fit_line(std::span<const double> x, std::span<const double> y, std::span<const double> w) {
    double sum_w = 0, sum_x = 0, sum_y = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        sum_w += w[i];
        sum_x += w[i] * x[i];
        sum_y += w[i] * y[i];
    }
    const double mean_x = sum_x / sum_w;
    const double mean_y = sum_y / sum_w;
    double sum_xx = 0, sum_xy = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        sum_xx += w[i] * (x[i] - mean_x) * (x[i] - mean_x);
        sum_xy += w[i] * (x[i] - mean_x) * (y[i] - mean_y);
    }
    const double slope = sum_xy / sum_xx;
    return {.intercept = mean_y - slope * mean_x, .slope = slope};
}

// In log-log.
Line fit_power(std::span<const double> efforts, std::span<const double> errors) {
    const std::vector<double> ones(efforts.size(), 1);
    return fit_line(logarithms(efforts), logarithms(errors), ones);
}

// On lines between the points in log-log; `log_effort` is within their range.
double log_error_at(std::span<const double> efforts, std::span<const double> errors,
                    double log_effort) {
    std::size_t k = 1;
    while (k + 1 < efforts.size() && std::log(efforts[k]) < log_effort) ++k;
    const double x0 = std::log(efforts[k - 1]);
    const double x1 = std::log(efforts[k]);
    const double y0 = std::log(errors[k - 1]);
    const double y1 = std::log(errors[k]);
    return y0 + (y1 - y0) * (log_effort - x0) / (x1 - x0);
}

SeedCurves without_seed(const SeedCurves& curves, std::size_t seed) {
    SeedCurves rest = curves;
    rest.errors.erase(rest.errors.begin() + static_cast<std::ptrdiff_t>(seed));
    return rest;
}

// exp(theta) with its interval; theta_without gives theta of all seeds but one, if it can.
Estimate jackknifed(double theta, std::size_t n_seeds,
                    const std::function<std::optional<double>(std::size_t)>& theta_without) {
    Estimate estimate{.value = std::exp(theta), .interval = std::nullopt, .why_none = std::nullopt};
    const auto n = static_cast<double>(n_seeds);
    std::vector<double> pseudo_values;
    for (std::size_t seed = 0; seed < n_seeds && n_seeds >= kFewestForInterval; ++seed) {
        const std::optional<double> without = theta_without(seed);
        if (!without) {
            estimate.why_none = NoInterval::Unbounded;
            return estimate;
        }
        pseudo_values.push_back(n * theta - (n - 1) * *without);
    }
    const std::optional<Estimate> spread = estimate_mean(pseudo_values);
    if (!spread || !spread->interval) {
        estimate.why_none = spread ? spread->why_none : NoInterval::TooFewValues;
        return estimate;
    }
    const double half_width = (spread->interval->high - spread->interval->low) / 2;
    estimate.interval =
        Interval{.low = std::exp(theta - half_width), .high = std::exp(theta + half_width)};
    return estimate;
}

// An error that is reached up to rounding is reached.
constexpr double kRounding = 1e-12;

struct LogEffort {
    EffortTo::Where where = EffortTo::Where::Never;
    double value = 0;
};
LogEffort log_effort_to_reach(const SeedCurves& curves, double error) {
    using Where = EffortTo::Where;
    const std::vector<double>& efforts = curves.efforts;
    const std::vector<double> errors = mean_curve(curves);
    error *= 1 + kRounding;
    if (errors.front() <= error) return {Where::Before, std::log(efforts.front())};
    for (std::size_t k = 1; k < errors.size(); ++k) {
        if (errors[k] > error) continue;
        const double share = std::log(errors[k - 1] / error) / std::log(errors[k - 1] / errors[k]);
        return {Where::Within,
                std::log(efforts[k - 1]) + share * std::log(efforts[k] / efforts[k - 1])};
    }
    if (efforts.size() < 2) return {};
    const double slope = -fit_power(efforts, errors).slope;
    if (slope <= 0) return {};
    return {Where::Beyond, std::log(efforts.back()) + std::log(errors.back() / error) / slope};
}

// Where log error(a) - log error(b) changes its sign.
struct Crossings {
    std::vector<double> log_efforts;
    double first = 0;  // that difference at the least common effort at which it is not zero
    double last = 0;
};
Crossings crossings_of(const SeedCurves& a, const SeedCurves& b) {
    const std::vector<double> errors_a = mean_curve(a);
    const std::vector<double> errors_b = mean_curve(b);
    const double low = std::max(a.efforts.front(), b.efforts.front());
    const double high = std::min(a.efforts.back(), b.efforts.back());
    std::vector<double> knots;
    for (const auto* efforts : {&a.efforts, &b.efforts}) {
        for (const double effort : *efforts) {
            if (low <= effort && effort <= high) knots.push_back(std::log(effort));
        }
    }
    std::ranges::sort(knots);
    Crossings crossings;
    double knot_before = 0;
    for (const double knot : knots) {
        const double difference =
            log_error_at(a.efforts, errors_a, knot) - log_error_at(b.efforts, errors_b, knot);
        if (difference == 0) continue;
        if (crossings.first == 0) crossings.first = difference;
        if (crossings.last * difference < 0) {
            const double share = crossings.last / (crossings.last - difference);
            crossings.log_efforts.push_back(knot_before + share * (knot - knot_before));
        }
        crossings.last = difference;
        knot_before = knot;
    }
    return crossings;
}

}  // namespace

std::vector<double> mean_curve(const SeedCurves& curves) {
    MISBENCH_CHECK(!curves.errors.empty());
    std::vector<double> means(curves.efforts.size(), 0);
    for (const std::vector<double>& errors : curves.errors) {
        MISBENCH_CHECK(errors.size() == means.size());
        for (std::size_t k = 0; k < means.size(); ++k) {
            means[k] += errors[k] / static_cast<double>(curves.errors.size());
        }
    }
    return means;
}

std::optional<Estimate> fit_slope(const SeedCurves& curves) {
    if (curves.efforts.size() < 2 || curves.errors.empty()) return std::nullopt;
    std::vector<double> slopes;
    for (const std::vector<double>& errors : curves.errors) {
        if (!is_above_zero(errors)) return std::nullopt;
        slopes.push_back(-fit_power(curves.efforts, errors).slope);
    }
    return estimate_mean(slopes);
}

// All seeds have the weights of the mean curve, so that each fit is linear in the seed's errors and
// the mean of the fits has no bias from the noise of weights.
std::optional<Estimate> fit_floor(const SeedCurves& curves) {
    if (curves.efforts.size() < 3 || curves.errors.empty()) return std::nullopt;
    const std::vector<double> means = mean_curve(curves);
    if (!is_above_zero(means)) return std::nullopt;
    std::vector<double> x, weights, floors;
    for (std::size_t k = 0; k < means.size(); ++k) {
        x.push_back(1 / curves.efforts[k]);
        weights.push_back(1 / (means[k] * means[k]));
    }
    for (const std::vector<double>& errors : curves.errors) {
        floors.push_back(fit_line(x, errors, weights).intercept);
    }
    return estimate_mean(floors);
}

std::optional<EffortTo> effort_to_reach(const SeedCurves& curves, double error,
                                        const std::optional<Estimate>& floor) {
    if (curves.efforts.empty() || curves.errors.empty() || !is_above_zero(mean_curve(curves))) {
        return std::nullopt;
    }
    const LogEffort reached = log_effort_to_reach(curves, error);
    EffortTo result{.where = reached.where, .effort = std::nullopt};
    if (reached.where == EffortTo::Where::Beyond && floor && has_floor(*floor) &&
        floor->interval->low >= error) {
        result.where = EffortTo::Where::Never;
    }
    if (result.where == EffortTo::Where::Never) return result;
    if (result.where == EffortTo::Where::Before) {
        result.effort = {.value = curves.efforts.front(),
                         .interval = std::nullopt,
                         .why_none = NoInterval::Unbounded};
        return result;
    }
    result.effort = jackknifed(reached.value, curves.errors.size(),
                               [&](std::size_t seed) -> std::optional<double> {
                                   const SeedCurves rest = without_seed(curves, seed);
                                   if (!is_above_zero(mean_curve(rest))) return std::nullopt;
                                   const LogEffort without = log_effort_to_reach(rest, error);
                                   if (without.where == EffortTo::Where::Never) return std::nullopt;
                                   return without.value;
                               });
    return result;
}

std::optional<Crossover> crossover(const SeedCurves& a, const SeedCurves& b) {
    MISBENCH_CHECK(a.errors.size() == b.errors.size());
    if (a.errors.empty() || a.efforts.size() < 2 || b.efforts.size() < 2) return std::nullopt;
    if (!is_above_zero(mean_curve(a)) || !is_above_zero(mean_curve(b))) return std::nullopt;
    const Crossings all = crossings_of(a, b);
    if (all.first == 0) return std::nullopt;
    Crossover result{.n_crossings = static_cast<int>(all.log_efforts.size()),
                     .is_first_ahead = all.first < 0,
                     .is_last_ahead = all.last < 0,
                     .effort = std::nullopt};
    if (all.log_efforts.empty()) return result;
    result.effort = jackknifed(
        all.log_efforts.back(), a.errors.size(), [&](std::size_t seed) -> std::optional<double> {
            const SeedCurves rest_a = without_seed(a, seed);
            const SeedCurves rest_b = without_seed(b, seed);
            if (!is_above_zero(mean_curve(rest_a)) || !is_above_zero(mean_curve(rest_b))) {
                return std::nullopt;
            }
            const Crossings without = crossings_of(rest_a, rest_b);
            if (without.log_efforts.empty()) return std::nullopt;
            return without.log_efforts.back();
        });
    return result;
}

std::vector<bool> pareto_front(std::span<const CostAndError> points) {
    std::vector<bool> on_front;
    for (const CostAndError& point : points) {
        on_front.push_back(std::ranges::none_of(points, [&point](const CostAndError& other) {
            return other.cost <= point.cost && other.error <= point.error &&
                   (other.cost < point.cost || other.error < point.error);
        }));
    }
    return on_front;
}

}  // namespace misbench
