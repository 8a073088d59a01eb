// Variance, bias² and the noise of the reference are estimated without bias, from few noisy images
// and a noisy reference. Alpha is 0.01 for the whole binary.
#include "results/metrics/error_parts.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/support/statistics.h"

namespace misbench {
namespace {

constexpr int kComparisons = 7;
constexpr int kTrials = 2000;
constexpr float kTruth = 2.0F;
constexpr float kBias = 0.125F;

// Skewed noise of deviation `deviation` on a constant image.
Image noisy(float mean, float deviation, std::mt19937& random) {
    std::exponential_distribution<float> exponential(1.0F);
    Image image(6, 5);
    for (float& value : image.rgb) value = mean + deviation * (exponential(random) - 1.0F);
    return image;
}

struct Estimates {
    std::vector<double> variance, bias_squared, reference_noise;
};

Estimates estimates(const Metric& metric, int n_images, float bias, unsigned seed) {
    std::mt19937 random(seed);
    Estimates found;
    for (int trial = 0; trial < kTrials; ++trial) {
        const Image a = noisy(kTruth, 0.25F, random);
        const Image b = noisy(kTruth, 0.25F, random);
        ErrorPartsSum sum(metric, {a, b});
        for (int i = 0; i < n_images; ++i) sum.add(noisy(kTruth + bias, 0.5F, random));
        found.variance.push_back(sum.parts().variance);
        found.bias_squared.push_back(sum.parts().bias_squared);
        found.reference_noise.push_back(reference_noise(metric, {a, b}));
    }
    return found;
}

void expect_mean(const std::vector<double>& values, double expected) {
    EXPECT_GT(test::p_value_of_mean(values, expected), test::sidak(0.01, kComparisons)) << expected;
}

TEST(ErrorParts, AreUnbiasedWhereTheReferenceIsAsNoisyAsItGets) {
    const Metric& metric = find_metric("mse");
    const Estimates two = estimates(metric, 2, kBias, 1);
    expect_mean(two.variance, 0.25);
    expect_mean(two.bias_squared, 0.125 * 0.125);
    // Of the mean of both halves.
    expect_mean(two.reference_noise, 0.25 * 0.25 / 2);
    const Estimates six = estimates(metric, 6, kBias, 2);
    expect_mean(six.variance, 0.25);
    expect_mean(six.bias_squared, 0.125 * 0.125);
}

TEST(ErrorParts, FindNoBiasWhereThereIsNone) {
    const Estimates found = estimates(find_metric("mse"), 4, 0.0F, 3);
    expect_mean(found.variance, 0.25);
    expect_mean(found.bias_squared, 0);
}

}  // namespace
}  // namespace misbench
