#include "results/metrics/error_parts.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "renderer/base/error.h"

namespace misbench {
namespace {

Image noise(unsigned seed, float offset = 0.0F) {
    Image image(13, 7);
    std::mt19937 random(seed);
    std::gamma_distribution<float> gamma(2.0F, 0.5F);
    for (float& value : image.rgb) value = gamma(random) + offset;
    return image;
}

std::vector<Image> images(int n) {
    std::vector<Image> images;
    for (int i = 0; i < n; ++i) images.push_back(noise(static_cast<unsigned>(10 + i), 0.25F));
    return images;
}

ErrorParts parts_of(const Metric& metric, const std::vector<Image>& images,
                    const ReferencePair& reference) {
    ErrorPartsSum sum(metric, reference);
    for (const Image& image : images) sum.add(image);
    EXPECT_EQ(sum.n_images(), static_cast<int>(images.size()));
    return sum.parts();
}

double value_at(const Image& image, std::size_t i) { return static_cast<double>(image.rgb[i]); }

// Every pair of images, and every image's difference from their mean, as the formulas have it.
ErrorParts slow_parts(const Metric& metric, const std::vector<Image>& images,
                      const ReferencePair& reference) {
    const auto n = static_cast<double>(images.size());
    ErrorParts parts;
    const std::size_t n_values = reference.a.rgb.size();
    for (std::size_t v = 0; v < n_values; ++v) {
        const double a = value_at(reference.a, v);
        const double b = value_at(reference.b, v);
        const double weight = 1 / metric.denominator((a + b) / 2) / static_cast<double>(n_values);
        double mean = 0;
        for (const Image& image : images) mean += value_at(image, v) / n;
        for (std::size_t i = 0; i < images.size(); ++i) {
            const double from_mean = value_at(images[i], v) - mean;
            parts.variance += weight * from_mean * from_mean / (n - 1);
            for (std::size_t j = 0; j < images.size(); ++j) {
                if (i == j) continue;
                parts.bias_squared += weight * (value_at(images[i], v) - a) *
                                      (value_at(images[j], v) - b) / (n * (n - 1));
            }
        }
    }
    return parts;
}

TEST(ErrorParts, AreThoseOfTheSumOverAllPairs) {
    const Image a = noise(1);
    const Image b = noise(2);
    for (const char* id : {"mse", "relmse.eps0.01", "mrse.eps0.01"}) {
        const Metric& metric = find_metric(id);
        for (const int n : {2, 3, 8}) {
            const auto fast = parts_of(metric, images(n), {a, b});
            const auto slow = slow_parts(metric, images(n), {a, b});
            EXPECT_NEAR(fast.variance, slow.variance, 1e-12 * slow.variance) << id;
            EXPECT_NEAR(fast.bias_squared, slow.bias_squared, 1e-11 * slow.variance) << id;
        }
    }
}

TEST(ErrorParts, AddUpToTheMeanError) {
    const Image a = noise(1);
    const Image b = noise(2);
    const Metric& metric = find_metric("relmse.eps0.01");
    const auto parts = parts_of(metric, images(5), {a, b});
    double error = 0;
    for (const Image& image : images(5)) error += measure(metric, image, {a, b}) / 5;
    EXPECT_NEAR(parts.variance + parts.bias_squared, error, 1e-11 * error);
}

TEST(ErrorParts, OfEqualImagesAreBiasAlone) {
    const Image reference = noise(1);
    const Image same = noise(1, 0.5F);
    const auto parts = parts_of(find_metric("mse"), {same, same, same}, {reference, reference});
    EXPECT_EQ(parts.variance, 0);
    EXPECT_NEAR(parts.bias_squared, 0.25, 1e-6);
}

TEST(ErrorParts, SurviveAFireflyBesideWhatIsDark) {
    std::vector<Image> dark(3, Image(4, 4));
    dark[1].rgb[0] = 1e12F;
    const Image black(4, 4);
    const auto parts = parts_of(find_metric("mse"), dark, {black, black});
    EXPECT_NEAR(parts.variance, 1e24 / 3 / 48, 1e16);
    EXPECT_NEAR(parts.bias_squared, 0, 1e8);
}

TEST(ErrorParts, AreRefusedForWhatIsNoSquaredErrorAndForOtherSizes) {
    const Image a = noise(1);
    const Image turned(7, 13);
    EXPECT_THROW(ErrorPartsSum(find_metric("smape.eps0.01"), {a, a}), Error);
    EXPECT_THROW(ErrorPartsSum(find_metric("mse"), {a, turned}), Error);
    ErrorPartsSum sum(find_metric("mse"), {a, a});
    EXPECT_THROW(sum.add(turned), Error);
    EXPECT_THROW(reference_noise(find_metric("flip.ldr.ppd67"), {a, a}), Error);
    EXPECT_THROW(reference_noise(find_metric("mse"), {a, turned}), Error);
}

TEST(ReferenceNoise, IsWhatTheErrorAgainstTheMeanHasMore) {
    const Image image = noise(1);
    const Image a = noise(2);
    const Image b = noise(3);
    for (const char* id : {"mse", "relmse.eps0.01", "mrse.eps0.01"}) {
        const Metric& metric = find_metric(id);
        double naive = 0;
        double noise = 0;
        for (std::size_t i = 0; i < image.rgb.size(); ++i) {
            const double mean = 0.5 * (value_at(a, i) + value_at(b, i));
            const double half = 0.5 * (value_at(a, i) - value_at(b, i));
            const double difference = value_at(image, i) - mean;
            naive += difference * difference / metric.denominator(mean);
            noise += half * half / metric.denominator(mean);
        }
        const double found = reference_noise(metric, {a, b});
        EXPECT_NEAR(found, noise / static_cast<double>(image.rgb.size()), 1e-12) << id;
        EXPECT_NEAR(reference_noise_share(measure(metric, image, {a, b}), found), noise / naive,
                    1e-12)
            << id;
    }
    EXPECT_EQ(reference_noise_share(0, 0), 0);
    EXPECT_EQ(reference_noise_share(19, 1), kMaxReferenceNoiseShare);
}

}  // namespace
}  // namespace misbench
