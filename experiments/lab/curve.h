// Functions on an interval, each a sum of named shapes with a closed integral: integrands as they
// are written, densities normalised.
#pragma once

#include <span>
#include <variant>
#include <vector>

namespace misbench::lab {

struct Domain {
    double low = 0;
    double high = 1;
    bool contains(double x) const { return x >= low && x <= high; }
};

// Shapes: value(x), and integral_to(x) up to a constant. Edges are where a quadrature must stop:
// kinks, and what it could step over.

// 1 / (high - low)
struct Uniform {
    Domain on;
    double value(double x) const;
    double integral_to(double x) const;
    std::vector<double> edges() const { return {}; }
};

// A straight line with these values at the ends of the domain.
struct Linear {
    Domain on;
    double from = 0;
    double to = 0;
    double value(double x) const;
    double integral_to(double x) const;
    std::vector<double> edges() const { return {}; }
};

// The normal density.
struct Gaussian {
    double mean = 0;
    double deviation = 1;
    double value(double x) const;
    double integral_to(double x) const;
    std::vector<double> edges() const;
};

// The beta density, stretched to the domain. a, b >= 1.
struct Beta {
    Domain on;
    double a = 1;
    double b = 1;
    double value(double x) const;
    double integral_to(double x) const;
    std::vector<double> edges() const;
};

// Straight lines between points of growing x; 0 outside.
struct Table {
    std::vector<double> x;
    std::vector<double> y;
    double value(double at) const;
    double integral_to(double at) const;
    std::vector<double> edges() const { return x; }
};

struct Term {
    std::variant<Uniform, Linear, Gaussian, Beta, Table> shape;
    double weight = 1;
    Domain support;  // 0 outside
};

class Curve {
 public:
    Curve(std::vector<Term> terms, Domain domain);
    double value(double x) const;
    // From the domain's low end to x.
    double integral_to(double x) const;
    // In the domain, growing, its ends included.
    std::span<const double> edges() const { return edges_; }

 private:
    std::vector<Term> terms_;
    Domain domain_;
    std::vector<double> edges_;
};

// REQUIRES: the curve is nowhere below 0 and has an integral above 0.
class Density {
 public:
    explicit Density(Curve curve);
    double value(double x) const { return curve_.value(x) / mass_; }
    double cumulative(double x) const { return curve_.integral_to(x) / mass_; }
    // The inverse of cumulative(), for u in (0, 1).
    double quantile(double u) const;
    std::span<const double> edges() const { return curve_.edges(); }

 private:
    Curve curve_;
    double mass_;
    std::vector<double> cumulative_at_edges_;
};

}  // namespace misbench::lab
