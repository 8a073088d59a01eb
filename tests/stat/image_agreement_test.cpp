// The comparison of images by which estimators are judged, on made-up images whose expectations are
// known.
#include "tests/support/image_agreement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <iostream>
#include <random>

namespace misbench::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kRate = 0.01;
constexpr int kWidth = 48;
constexpr int kHeight = 32;
constexpr int kSeeds = 16;

const PixelMask kAllPixels(std::size_t{kWidth} * kHeight, 1);

// A positive number of mean 1, whose logarithm is normal with standard deviation `spread`: 0 is
// constant, 0.5 is skewed a little, of 2 rare values make up most of the mean.
class Noise {
 public:
    Noise(std::int64_t seed, double spread)
        : engine_(static_cast<std::uint64_t>(seed)),
          logarithm_(-0.5 * spread * spread, spread > 0 ? spread : 1),
          is_constant_(spread == 0) {}
    double operator()() { return is_constant_ ? 1 : std::exp(logarithm_(engine_)); }

 private:
    std::mt19937_64 engine_;
    std::normal_distribution<double> logarithm_;
    bool is_constant_;
};

// Brightness varies over the image; channels are the same up to a factor, as they often are.
Image noisy_image(std::int64_t seed, double spread) {
    Noise noise(seed, spread);
    Image image(kWidth, kHeight);
    for (std::size_t i = 0; i < image.n_pixels(); ++i) {
        const double value = (0.1 + static_cast<double>(i % 48) / 48) * noise();
        image.rgb[3 * i] = static_cast<float>(value);
        image.rgb[3 * i + 1] = static_cast<float>(0.5 * value);
        image.rgb[3 * i + 2] = static_cast<float>(0.7 * value);
    }
    return image;
}

void scale(Image& image, const PixelRange& pixels, double factor) {
    for (int y = pixels.y0; y < pixels.y1; ++y) {
        for (int x = pixels.x0; x < pixels.x1; ++x) {
            for (std::size_t c = 0; c < 3; ++c) {
                float& value = image.rgb[3 * static_cast<std::size_t>(y * kWidth + x) + c];
                value = static_cast<float>(double{value} * factor);
            }
        }
    }
}

// Images of noise, of which `pixels` are too bright by a factor.
ImageSource source(const std::string& name, std::int64_t base_seed, double spread,
                   PixelRange pixels = {}, double factor = 1) {
    return {.name = name,
            .image =
                [=](std::int64_t seed) {
                    Image image = noisy_image(base_seed + seed, spread);
                    scale(image, pixels, factor);
                    return image;
                },
            .mask = kAllPixels};
}

Agreement compare(const ImageSource& a, const ImageSource& b) {
    return compare_all_pairs(
        std::array{a, b}, {.scene = "made-up", .n_seeds = kSeeds, .false_discovery_rate = kRate});
}

// The chance of so many events or more, each of that probability.
double p_value_of_count(int n_events, int n, double probability) {
    if (n_events == 0) return 1;
    return boost::math::cdf(
        boost::math::complement(boost::math::binomial(n, probability), n_events - 1));
}

constexpr PixelRange kTile = {16, 8, 24, 16};
constexpr PixelRange kImage = {0, 0, kWidth, kHeight};

TEST(Discoveries, FollowBenjaminiAndHochberg) {
    // Limits at rate 0.05: 0.01, 0.02, 0.03, 0.04, 0.05.
    EXPECT_EQ(largest_discovery({0.2, 0.029, 0.5, 0.021, 0.011}, 0.05), 0.029);
    EXPECT_EQ(largest_discovery({0.2, 0.031, 0.5, 0.021, 0.011}, 0.05), -1);
    EXPECT_EQ(largest_discovery({0.2, 0.031, 0.5, 0.021, 0.01}, 0.05), 0.01);
    EXPECT_EQ(largest_discovery({}, 0.05), -1);
}

// By hand: means 2 and 4, variances of the means 1 / 3 and 4 / 3; t = 2 / √(5 / 3), ν = 50 / 17.
TEST(Welch, HasTheNumbersOfAnExampleByHand) {
    const auto images = [](std::initializer_list<float> values) {
        std::vector<Image> all;
        for (const float value : values) {
            all.emplace_back(1, 1);
            all.back().rgb = {value, value, value};
        }
        return all;
    };
    const auto tests = welch_tests(images({1, 2, 3}), images({2, 4, 6}), PixelMask{1});
    ASSERT_EQ(tests.size(), 3);
    EXPECT_DOUBLE_EQ(tests[0].first.value, 2);
    EXPECT_DOUBLE_EQ(tests[0].second.value, 4);
    EXPECT_DOUBLE_EQ(tests[0].first.standard_error, std::sqrt(1.0 / 3));
    EXPECT_DOUBLE_EQ(tests[0].second.standard_error, std::sqrt(4.0 / 3));
    EXPECT_NEAR(tests[0].degrees_of_freedom, 50.0 / 17, 1e-12);
    EXPECT_NEAR(tests[0].p_value, 0.2209, 1e-3);
}

TEST(Welch, HasUniformPValuesWhereImagesAreEqual) {
    constexpr int kFamilies = 200;
    std::vector<int> counts(10, 0);
    int n = 0;
    for (int family = 0; family < kFamilies; ++family) {
        std::vector<Image> a;
        std::vector<Image> b;
        for (int i = 0; i < kSeeds; ++i) {
            a.push_back(noisy_image(family * 1000 + i, 0.5));
            b.push_back(noisy_image(family * 1000 + 500 + i, 1));
        }
        // The channels are the same up to rounding; one is enough.
        for (const TileTest& test : welch_tests(a, b, kAllPixels)) {
            if (test.channel != 0 || test.is_image) continue;
            ++n;
            ++counts[static_cast<std::size_t>(std::min(9.0, 10 * test.p_value))];
        }
    }
    for (const int count : counts) {
        EXPECT_NEAR(count, 0.1 * n, 5 * std::sqrt(0.09 * n)) << testing::PrintToString(counts);
    }
}

// Of how many families of made-up images a first look finds a difference, and how many it keeps.
struct Alarms {
    int first = 0;
    int confirmed = 0;
};
Alarms alarms(int n_families, double spread_a, double spread_b) {
    Alarms result;
    for (int family = 0; family < n_families; ++family) {
        const std::int64_t seed = std::int64_t{10'000'000} * (family + 1);
        const Agreement agreement =
            compare(source("a", seed, spread_a), source("b", seed, spread_b));
        if (!agreement.disagreements.empty()) ++result.confirmed;
        if (!agreement.disagreements.empty() || !agreement.withdrawn.empty()) ++result.first;
    }
    return result;
}

TEST(Agreement, RaisesNoFalseAlarmsOnEqualEstimators) {
    constexpr int kFamilies = 150;
    const Alarms found = alarms(kFamilies, 0.5, 1);
    EXPECT_GT(p_value_of_count(found.first, kFamilies, kRate), 0.001);
    EXPECT_EQ(found.confirmed, 0) << found.first << " at the first look";
}

// With spread 2 half of the brightness is in one pixel of 44, with spread 3 in one of 740: a tile
// of 64 pixels and 16 seeds just has some of those.
TEST(Agreement, RaisesFewFalseAlarmsWhereTailsAreHeavy) {
    constexpr int kFamilies = 60;
    const Alarms heavy = alarms(kFamilies, 0.1, 2);
    EXPECT_GT(p_value_of_count(heavy.confirmed, kFamilies, kRate), 0.001);
    const Alarms very_heavy = alarms(kFamilies, 0.1, 3);
    EXPECT_LE(very_heavy.confirmed, kFamilies / 10);
    std::cout << "of " << kFamilies << " families, spread 2: " << heavy.first
              << " alarms at the first look, " << heavy.confirmed
              << " confirmed; spread 3: " << very_heavy.first << ", " << very_heavy.confirmed
              << '\n';
}

// One image of twelve has a firefly of a sixth of the tile's light: in one case of four no seed of
// the first look sees it, and the rest is exact.
TEST(Agreement, WithdrawsWhatTheFirstSeedsDidNotSee) {
    const ImageSource exact = source("exact", 0, 0);
    int n_withdrawn = 0;
    for (int family = 0; family < 60; ++family) {
        ImageSource rare = source("rare", 0, 0, kTile, 1.0 - 1.0 / 6);
        rare.image = [image = rare.image, family](std::int64_t seed) {
            Image result = image(seed);
            std::mt19937_64 engine(static_cast<std::uint64_t>(1000 * family + seed));
            if (std::uniform_real_distribution<double>()(engine) < 1.0 / 12) {
                scale(result, kTile, (1 + 11.0 / 6) / (1 - 1.0 / 6));
            }
            return result;
        };
        const Agreement agreement = compare(exact, rare);
        EXPECT_THAT(agreement.disagreements, IsEmpty());
        if (!agreement.withdrawn.empty()) ++n_withdrawn;
    }
    EXPECT_GT(n_withdrawn, 5);
}

TEST(Agreement, FindsAPlantedBiasOfAFewStandardErrors) {
    constexpr int kFamilies = 40;
    // The standard error of the difference of two tiles' means, in parts of the mean.
    const double spread = 0.5;
    const double se = std::sqrt(2 * (std::exp(spread * spread) - 1) / 64 / kSeeds);
    const auto n_found = [&](double n_se) {
        int n = 0;
        for (int family = 0; family < kFamilies; ++family) {
            const std::int64_t seed = std::int64_t{10'000'000} * (family + 1);
            const Agreement agreement =
                compare(source("a", seed, spread), source("b", seed, spread, kTile, 1 + n_se * se));
            if (!agreement.disagreements.empty()) ++n;
        }
        std::cout << n_se << " standard errors in one tile: found in " << n << " of " << kFamilies
                  << '\n';
        return n;
    };
    n_found(4);
    EXPECT_GE(n_found(6), 0.7 * kFamilies);
    EXPECT_GE(n_found(8), 0.95 * kFamilies);
}

// What is promised to be found in four of five cases is found.
TEST(Agreement, SaysWhatItWouldFind) {
    const Agreement equal = compare(source("a", 1, 0.5), source("b", 1, 0.5));
    EXPECT_GT(equal.detectable_bias_of_tile, 4 * equal.detectable_bias_of_image);
    EXPECT_EQ(equal.n_tests, 3 * (24 + 2 + 1));
    int n_found = 0;
    for (int family = 0; family < 40; ++family) {
        const std::int64_t seed = std::int64_t{10'000'000} * (family + 1);
        const Agreement agreement =
            compare(source("a", seed, 0.5),
                    source("b", seed, 0.5, kImage, 1 + equal.detectable_bias_of_image));
        if (!agreement.disagreements.empty()) ++n_found;
    }
    EXPECT_GE(n_found, 28);
}

TEST(Agreement, NamesWhatDisagrees) {
    const Agreement agreement =
        compare(source("first", 1, 0.2), source("second", 1, 0.2, kTile, 1.5));
    ASSERT_FALSE(agreement.disagreements.empty());
    EXPECT_THAT(
        agreement.disagreements[0].text,
        AllOf(HasSubstr("scene 'made-up', pixels x 16 … 23, y 8 … 15, red: first 0."),
              HasSubstr(" against second 0."), HasSubstr(" ± "), HasSubstr("(64 seeds, p = ")));
}

TEST(Agreement, ComparesConstantTilesByRounding) {
    const auto differs = [](double factor) {
        return !compare(source("a", 1, 0), source("b", 1, 0, kTile, factor)).disagreements.empty();
    };
    EXPECT_FALSE(differs(1));
    EXPECT_FALSE(differs(1 + 0.5 * kRounding));
    EXPECT_TRUE(differs(1 + 2 * kRounding));
    EXPECT_TRUE(differs(0));
}

TEST(Agreement, AllowsABiasThatIsStatedAndNoMore) {
    const auto differs = [](double factor) {
        ImageSource biased = source("b", 1, 0, kTile, factor);
        biased.bias = 0.02;
        return !compare(source("a", 1, 0), biased).disagreements.empty();
    };
    EXPECT_FALSE(differs(1.019));
    EXPECT_FALSE(differs(0.982));
    // The tile is darker than the median of all: what is allowed is a part of the latter.
    EXPECT_TRUE(differs(1.04));
    EXPECT_TRUE(differs(0.96));
}

TEST(Agreement, ComparesOnlyPixelsThatBothEstimate) {
    ImageSource partial = source("b", 1, 0.2, kTile, 3);
    for (int y = kTile.y0; y < kTile.y1; ++y) {
        for (int x = kTile.x0; x < kTile.x1; ++x) {
            partial.mask[static_cast<std::size_t>(y * kWidth + x)] = 0;
        }
    }
    EXPECT_THAT(compare(source("a", 1, 0.2), partial).disagreements, IsEmpty());
    partial.mask = kAllPixels;
    EXPECT_FALSE(compare(source("a", 1, 0.2), partial).disagreements.empty());
}

}  // namespace
}  // namespace misbench::test
