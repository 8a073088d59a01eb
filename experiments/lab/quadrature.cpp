#include "experiments/lab/quadrature.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace misbench::lab {
namespace {

constexpr double kTolerance = 1e-10;
// A jump is within the tolerance after some 30 halvings; a pole never is.
constexpr int kMaxDepth = 40;

// Points of Kronrod's rule on [-1, 1] from the end to the middle, every second one of Gauss's.
constexpr std::array kPoints{
    0.991455371120812639206854697526329, 0.949107912342758524526189684047851,
    0.864864423359769072789712788640926, 0.741531185599394439863864773280788,
    0.586087235467691130294144691693013, 0.405845151377397166906606412076961,
    0.207784955007898467600689403773245, 0.0};
constexpr std::array kKronrod{
    0.022935322010529224963732008058970, 0.063092092629978553290700663189204,
    0.104790010322250183839876322541518, 0.140653259715525918745189590510238,
    0.169004726639267902826583426598550, 0.190350578064785409913256402421014,
    0.204432940075298892414161999234649, 0.209482141084727828012999174891714};
constexpr std::array kGauss{
    0.129484966168869693270611432679082, 0.279705391489276667901467771423780,
    0.381830050505118944950369775488975, 0.417959183673469387755102040816327};

struct Rule {
    std::vector<double> value;
    std::vector<double> error;
    std::vector<double> absolute;  // the integral of the absolute value
};

Rule apply_rule(const Functions& functions, std::size_t n_functions, double low, double high) {
    const double center = 0.5 * (low + high);
    const double half = 0.5 * (high - low);
    Rule rule{std::vector<double>(n_functions), std::vector<double>(n_functions),
              std::vector<double>(n_functions)};
    std::vector<double> gauss(n_functions);
    std::vector<double> values(n_functions);
    const auto add = [&](std::size_t point, double sign) {
        functions(center + sign * half * kPoints[point], values);
        const double gauss_weight = point % 2 == 1 ? kGauss[point / 2] : 0;
        for (std::size_t j = 0; j < n_functions; ++j) {
            rule.value[j] += half * kKronrod[point] * values[j];
            rule.absolute[j] += half * kKronrod[point] * std::abs(values[j]);
            gauss[j] += half * gauss_weight * values[j];
        }
    };
    for (std::size_t point = 0; point + 1 < kPoints.size(); ++point) {
        add(point, -1);
        add(point, 1);
    }
    add(kPoints.size() - 1, 0);
    for (std::size_t j = 0; j < n_functions; ++j)
        rule.error[j] = std::abs(rule.value[j] - gauss[j]);
    return rule;
}

// Of one piece.
class Adaptive {
 public:
    Adaptive(const Functions& functions, std::span<const double> scales, Integrals& result)
        : functions_(functions), scales_(scales), result_(result) {}

    void add(const Rule& rule, double low, double high, int depth) {
        if (!result_.converged) return;
        if (worst(rule) <= kTolerance) {
            for (std::size_t j = 0; j < scales_.size(); ++j) {
                result_.pieces.back()[j] += rule.value[j];
                result_.errors[j] += rule.error[j];
            }
            return;
        }
        const double center = 0.5 * (low + high);
        if (depth == kMaxDepth || !(low < center && center < high)) {
            result_.converged = false;
            return;
        }
        const Rule left = apply_rule(functions_, scales_.size(), low, center);
        const Rule right = apply_rule(functions_, scales_.size(), center, high);
        // The worse half first, which leads straight to a pole and an end.
        if (worst(left) > worst(right)) {
            add(left, low, center, depth + 1);
            add(right, center, high, depth + 1);
        } else {
            add(right, center, high, depth + 1);
            add(left, low, center, depth + 1);
        }
    }

 private:
    // The largest error in units of its function's scale; not a number where one is not.
    double worst(const Rule& rule) const {
        double worst = 0;
        for (std::size_t j = 0; j < scales_.size(); ++j) {
            if (rule.error[j] == 0) continue;
            const double error = rule.error[j] / scales_[j];
            if (!(error <= worst)) worst = error;
        }
        return worst;
    }

    const Functions& functions_;
    std::span<const double> scales_;
    Integrals& result_;
};

}  // namespace

double Integrals::total(std::size_t function) const {
    double sum = 0;
    for (const auto& piece : pieces) sum += piece[function];
    return sum;
}

Integrals integrate(const Functions& functions, std::size_t n_functions,
                    std::span<const double> edges) {
    std::vector<Rule> first;
    std::vector<double> scales(n_functions);
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
        first.push_back(apply_rule(functions, n_functions, edges[i], edges[i + 1]));
        for (std::size_t j = 0; j < n_functions; ++j) scales[j] += first.back().absolute[j];
    }
    Integrals result{.pieces = {}, .errors = std::vector<double>(n_functions)};
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
        result.pieces.emplace_back(n_functions);
        Adaptive(functions, scales, result).add(first[i], edges[i], edges[i + 1], 0);
    }
    return result;
}

}  // namespace misbench::lab
