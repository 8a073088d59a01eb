// The parts of a squared error: variance and bias² of a method from several of its images, and the
// noise of the reference.
//
//   n images I_i of independent seeds, mean m(p), unbiased variance s²(p), r1 r2 R as in metrics.h
//
// Of the independent pairs of different images, the cross-seed estimator
//     B² = 1/(n(n-1)) Σ_{i≠j} (I_i - r1)(I_j - r2) = (m - r1)(m - r2) - s²/n
// has no variance in it: E[B²] = Bias². With s² it is the mean error, to the last pixel:
//     s² + B² = 1/n Σ_i (I_i - r1)(I_i - r2)
#pragma once

#include <vector>

#include "results/metrics/metrics.h"

namespace misbench {

struct ErrorParts {
    double variance = 0;
    double bias_squared = 0;  // an estimate without bias of its own, so it may be negative
};

// Takes images one after the other and keeps none of them.
class ErrorPartsSum {
 public:
    // Throws InvalidArgument for a metric that is no squared error. Of a trimmed one the parts are
    // those of all pixels. The reference must outlive this object.
    ErrorPartsSum(const Metric& metric, const ReferencePair& reference);
    // Throws InvalidArgument when the image has another size than the reference.
    void add(const Image& image);
    int n_images() const { return n_images_; }
    // Means over pixels and channels, weighted like the metric. REQUIRES: at least two images.
    ErrorParts parts() const;

 private:
    const Metric& metric_;
    ReferencePair reference_;
    int n_images_ = 0;
    std::vector<double> mean_;
    std::vector<double> squares_;  // Σ (I - m)², Welford's
};

// The noise that a comparison with R would add to a squared error, weighted like the metric: the
// mean of ((r1 - r2)/2)², whose expectation is Var R. For a trimmed metric, of all pixels. Throws
// InvalidArgument for a metric that is no squared error.
double reference_noise(const Metric& metric, const ReferencePair& reference);

// Above this share a cell's reference is too noisy.
inline constexpr double kMaxReferenceNoiseShare = 0.05;

// The noise's share of the error against R: (I-R)² = (I-r1)(I-r2) + ((r1-r2)/2)², so `error` may be
// one image's measure by halves or their mean over seeds. 0 where there is neither.
double reference_noise_share(double error, double reference_noise);

}  // namespace misbench
