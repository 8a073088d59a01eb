// Error measures between an image and a reference given as two independent halves. An id names
// everything that a number depends on; sums are double, in pixel order.
//
//   I(p)  image, r1(p), r2(p)  halves of the reference, R = (r1 + r2)/2, per pixel and channel
//   d²(p) = (I - r1)(I - r2)   E[d²] = Var I + Bias²: the reference's noise cancels
//
// Only in squares does it cancel. What is no squared error is measured against R, noise and all.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/image/image.h"

namespace misbench {

struct ReferencePair {
    const Image& a;
    const Image& b;
};

// What a better method has.
enum class Direction { Less, More, None };
std::string to_string(Direction direction);  // "less", "more", "none"

// Over seeds every metric is averaged: the arithmetic mean. Across scenes only errors are, which
// are positive in expectation: the geometric mean of their ratios to a baseline.
enum class AcrossScenes { GeometricMeanOfRatios, Nothing };

struct Metric {
    std::string_view id;       // as written in an experiment, with its constants
    std::string_view formula;  // for `misbench list metrics`
    Direction better;          // None for measures that rank nothing, such as the mean
    double (*measure)(const Image& image, const ReferencePair& reference);
    // The same by pixel, row by row, before any aggregation; null where no such map exists.
    std::vector<double> (*map)(const Image& image, const ReferencePair& reference);
    AcrossScenes across_scenes;
    // Of a squared error, what a pixel's is divided by, of R; null for any other metric.
    double (*denominator)(double reference);
};

// "mean over seeds, geometric mean of ratios across scenes", "mean over seeds"
std::string aggregation(const Metric& metric);

std::span<const Metric> metrics();
// Throws ParameterError with the list of what is known.
const Metric& find_metric(const std::string& id);

// Throws InvalidArgument when the three images differ in size, or are empty.
void require_same_size(const Metric& metric, const Image& image, const ReferencePair& reference);

// Throws InvalidArgument when the three images differ in size.
double measure(const Metric& metric, const Image& image, const ReferencePair& reference);
// One value a pixel, row by row. Throws InvalidArgument like measure(), and for a metric without a
// map.
std::vector<double> measure_map(const Metric& metric, const Image& image,
                                const ReferencePair& reference);

}  // namespace misbench
