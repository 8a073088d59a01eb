#include "experiments/lab/curve.h"

#include <algorithm>
#include <boost/math/special_functions/beta.hpp>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "renderer/base/check.h"

namespace misbench::lab {
namespace {

double width(const Domain& domain) { return domain.high - domain.low; }

// How far x is through the domain, in [0, 1].
double position(const Domain& on, double x) {
    return std::clamp((x - on.low) / width(on), 0.0, 1.0);
}

// Where a quadrature that stops there cannot step over a peak.
std::vector<double> around(double mean, double deviation) {
    std::vector<double> edges;
    for (const int n : {-8, -4, -2, 0, 2, 4, 8}) edges.push_back(mean + n * deviation);
    return edges;
}

void sort_unique(std::vector<double>& values) {
    std::ranges::sort(values);
    values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace

double Uniform::value(double /*x*/) const { return 1 / width(on); }
double Uniform::integral_to(double x) const { return x / width(on); }

double Linear::value(double x) const { return std::lerp(from, to, position(on, x)); }
double Linear::integral_to(double x) const {
    const double t = position(on, x);
    return width(on) * t * (from + 0.5 * (to - from) * t);
}

double Gaussian::value(double x) const {
    const double z = (x - mean) / deviation;
    return std::exp(-0.5 * z * z) / (deviation * std::sqrt(2 * std::numbers::pi));
}
double Gaussian::integral_to(double x) const {
    return 0.5 * std::erfc((mean - x) / (deviation * std::numbers::sqrt2));
}
std::vector<double> Gaussian::edges() const { return around(mean, deviation); }

double Beta::value(double x) const {
    return boost::math::ibeta_derivative(a, b, position(on, x)) / width(on);
}
double Beta::integral_to(double x) const { return boost::math::ibeta(a, b, position(on, x)); }
std::vector<double> Beta::edges() const {
    const double deviation = std::sqrt(a * b / (a + b + 1)) / (a + b);
    return around(on.low + width(on) * a / (a + b), width(on) * deviation);
}

double Table::value(double at) const {
    if (at < x.front() || at > x.back()) return 0;
    const auto after = std::upper_bound(x.begin() + 1, x.end() - 1, at);
    const auto i = static_cast<std::size_t>(std::distance(x.begin(), after));
    return std::lerp(y[i - 1], y[i], (at - x[i - 1]) / (x[i] - x[i - 1]));
}
double Table::integral_to(double at) const {
    double sum = 0;
    for (std::size_t i = 1; i < x.size() && at > x[i - 1]; ++i) {
        const double end = std::min(at, x[i]);
        const double y_end = std::lerp(y[i - 1], y[i], (end - x[i - 1]) / (x[i] - x[i - 1]));
        sum += 0.5 * (y[i - 1] + y_end) * (end - x[i - 1]);
    }
    return sum;
}

Curve::Curve(std::vector<Term> terms, Domain domain) : terms_(std::move(terms)), domain_(domain) {
    edges_ = {domain.low, domain.high};
    const auto add = [&](double edge) {
        if (domain.contains(edge)) edges_.push_back(edge);
    };
    for (const Term& term : terms_) {
        add(term.support.low);
        add(term.support.high);
        for (const double edge :
             std::visit([](const auto& shape) { return shape.edges(); }, term.shape)) {
            add(edge);
        }
    }
    sort_unique(edges_);
}

double Curve::value(double x) const {
    double sum = 0;
    for (const Term& term : terms_) {
        if (!term.support.contains(x)) continue;
        sum +=
            term.weight * std::visit([x](const auto& shape) { return shape.value(x); }, term.shape);
    }
    return sum;
}

double Curve::integral_to(double x) const {
    double sum = 0;
    for (const Term& term : terms_) {
        const double low = std::max(domain_.low, term.support.low);
        const double high = std::min({x, domain_.high, term.support.high});
        if (high <= low) continue;
        sum += term.weight * std::visit(
                                 [&](const auto& shape) {
                                     return shape.integral_to(high) - shape.integral_to(low);
                                 },
                                 term.shape);
    }
    return sum;
}

Density::Density(Curve curve)
    : curve_(std::move(curve)), mass_(curve_.integral_to(curve_.edges().back())) {
    MISBENCH_CHECK(mass_ > 0);
    for (const double edge : curve_.edges()) cumulative_at_edges_.push_back(cumulative(edge));
}

double Density::quantile(double u) const {
    // Bracket it between two edges, then Newton's method, with bisection where that leaves.
    const auto above =
        std::upper_bound(cumulative_at_edges_.begin() + 1, cumulative_at_edges_.end() - 1, u);
    const auto i = static_cast<std::size_t>(std::distance(cumulative_at_edges_.begin(), above));
    double low = edges()[i - 1];
    double high = edges()[i];
    double x = 0.5 * (low + high);
    constexpr int kMaxSteps = 200;  // bisection alone needs some 60
    for (int step = 0; step < kMaxSteps && low < x && x < high; ++step) {
        const double excess = cumulative(x) - u;
        if (excess == 0) break;
        (excess > 0 ? high : low) = x;
        const double newton = x - excess / value(x);
        const double next = newton > low && newton < high ? newton : 0.5 * (low + high);
        if (next == x) break;
        x = next;
    }
    return x;
}

}  // namespace misbench::lab
