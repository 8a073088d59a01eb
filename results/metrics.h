// Error measures between an image and a reference given as two independent halves. An id names
// everything that a number depends on; sums are double, in pixel order.
//
//   I(p)  image, r1(p), r2(p)  halves of the reference, R = (r1 + r2)/2, per pixel and channel
//   d²(p) = (I - r1)(I - r2)   E[d²] = Var I + Bias²: the reference's noise cancels
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "renderer/image/image.h"

namespace misbench {

struct ReferencePair {
    const Image& a;
    const Image& b;
};

struct Metric {
    std::string_view id;       // as written in an experiment, with its constants
    std::string_view formula;  // for `misbench list metrics`
    bool less_is_better;       // false for measures that rank nothing, such as the mean
    double (*measure)(const Image& image, const ReferencePair& reference);
};

std::span<const Metric> metrics();
// Throws ParameterError with the list of what is known.
const Metric& find_metric(const std::string& id);

// Throws InvalidArgument when the three images differ in size.
double measure(const Metric& metric, const Image& image, const ReferencePair& reference);

}  // namespace misbench
