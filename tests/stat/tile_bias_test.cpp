// Tests of tiles raise false alarms no more often than they say, and find bias as often, by
// simulation without rendering: the tables of tile_test.h. Every test has fixed seeds.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "experiments/statistics/tile_test.h"

namespace misbench {
namespace {

using Images = std::vector<TileSums>;
constexpr int kSize = 96;  // pixels: 144 tiles, 9 tiles and the image

// Tile means around one; the 16 tiles of one of the nine in the middle scale have lost a part.
struct Source {
    double spread = 0.1;
    bool is_lognormal = false;
    double loss = 0;

    Images draw(std::mt19937_64& random, int n) const {
        std::normal_distribution<double> normal;
        Images images;
        for (int i = 0; i < n; ++i) {
            TileSums image{.width = kSize, .height = kSize, .sums = {}};
            for (int y = 0; y < kSize / 8; ++y) {
                for (int x = 0; x < kSize / 8; ++x) {
                    const double z = spread * normal(random);
                    const double noise = is_lognormal ? std::exp(z - spread * spread / 2) : 1 + z;
                    const bool is_dimmed = x / 4 == 1 && y / 4 == 1;
                    image.sums.push_back(64 * noise * (is_dimmed ? 1 - loss : 1));
                }
            }
            images.push_back(image);
        }
        return images;
    }
};

double rate(int n_trials, const auto& is_found) {
    std::mt19937_64 random(20250302);
    int n = 0;
    for (int trial = 0; trial < n_trials; ++trial) n += is_found(random) ? 1 : 0;
    return static_cast<double>(n) / n_trials;
}

double rate_of_alarms(int n_trials, int n, const Source& a, const Source& b, bool is_paired,
                      double alpha) {
    return rate(n_trials, [&](std::mt19937_64& random) {
        const Images of_a = a.draw(random, n);
        return test_tiles(of_a, b.draw(random, n), {.is_paired = is_paired}).p_value <= alpha;
    });
}

// 3.4 standard errors above the level.
TEST(TileTest, RaisesNoMoreFalseAlarmsThanItSays) {
    const Source normal;
    const Source skewed{.spread = 1, .is_lognormal = true};
    for (const int n : {5, 10}) {
        for (const bool is_paired : {false, true}) {
            EXPECT_LE(rate_of_alarms(100, n, normal, normal, is_paired, 0.05), 0.125);
            EXPECT_LE(rate_of_alarms(100, n, skewed, skewed, is_paired, 0.05), 0.125);
            // Of plain t-tests most experiments raise one.
            EXPECT_LE(rate_of_alarms(100, n, skewed, normal, is_paired, 0.05), 0.125);
        }
    }
}

TEST(TileTest, HasUniformPValuesWithoutBias) {
    std::mt19937_64 random(4);
    const Source normal;
    std::array<int, 10> sum{};
    for (int i = 0; i < 20; ++i) {
        const Images a = normal.draw(random, 10);
        const ImageTest test = test_tiles(a, normal.draw(random, 10), {});
        for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += test.scales[0].histogram[k];
    }
    // 288 expected in each: χ² of 9 degrees of freedom, at level 0.001.
    double statistic = 0;
    for (const int count : sum) statistic += (count - 288.0) * (count - 288.0) / 288;
    EXPECT_LT(statistic, 27.88);
}

TEST(TileTest, FindsBiasAsOftenAsItSays) {
    const auto found = [](int n, double loss) {
        return rate_of_alarms(100, n, Source{.loss = loss}, Source{}, false, 0.01);
    };
    EXPECT_GE(found(10, 0.05), 0.3);
    EXPECT_GE(found(10, 0.10), 0.9);
    EXPECT_GE(found(5, 0.20), 0.7);
    EXPECT_GE(found(20, 0.05), 0.9);
}

// At the minimum detectable bias of the whole image, in an image that is one tile.
TEST(TileTest, FindsTheMinimumDetectableBiasWithItsPower) {
    std::normal_distribution<double> normal;
    double detectable = 0;
    const auto draw = [&normal](std::mt19937_64& random, double mean) {
        Images images;
        for (int i = 0; i < 10; ++i) {
            images.push_back(
                {.width = 8, .height = 8, .sums = {64 * (mean + 0.1 * normal(random))}});
        }
        return images;
    };
    std::mt19937_64 first(1);
    for (int i = 0; i < 500; ++i) {
        const Images a = draw(first, 1);
        detectable += test_tiles(a, draw(first, 1), {}).scales[0].detectable_of_image / 500;
    }
    const double share = rate(2'000, [&](std::mt19937_64& random) {
        const Images a = draw(random, 1 - detectable);
        return test_tiles(a, draw(random, 1), {}).p_value <= 0.01;
    });
    EXPECT_NEAR(share, 0.74, 0.05);
}

// One tile of one image, seeds that correlate: why those of equal seeds are tested as pairs.
TEST(TileTest, OfPairsHoldsItsLevelHoweverSeedsCorrelate) {
    const auto alarms = [](double rho, int n, bool is_paired) {
        return rate(10'000, [&](std::mt19937_64& random) {
            std::normal_distribution<double> normal;
            Images a;
            Images b;
            for (int i = 0; i < n; ++i) {
                const double x = normal(random);
                const double y = rho * x + std::sqrt(1 - rho * rho) * normal(random);
                a.push_back({.width = 8, .height = 8, .sums = {64 + 10 * x}});
                b.push_back({.width = 8, .height = 8, .sums = {64 + 10 * y}});
            }
            const ImageTest test = test_tiles(a, b, {.is_paired = is_paired});
            return test.scales[0].tiles[0].p_value <= 0.01;
        });
    };
    for (const double rho : {-0.5, 0.0, 0.95}) {
        for (const int n : {3, 10}) EXPECT_NEAR(alarms(rho, n, true), 0.01, 0.004) << rho;
    }
    EXPECT_GT(alarms(-0.5, 10, false), 0.02);
    EXPECT_LT(alarms(0.95, 10, false), 0.001);
}

TEST(TileTest, SaysThatMeansAreEquivalentNoOftenerThanItSays) {
    const auto equivalent = [](double bias) {
        return rate(2'000, [&](std::mt19937_64& random) {
            std::normal_distribution<double> normal(0, 0.004);
            const auto draw = [&](double mean) {
                Images images;
                for (int i = 0; i < 10; ++i) {
                    images.push_back(
                        {.width = 8, .height = 8, .sums = {64 * (mean + normal(random))}});
                }
                return images;
            };
            const Images a = draw(1 + bias);
            const ImageTest test = test_tiles(a, draw(1), {.margin = 0.01});
            return test.scales.back().equivalence_p <= 0.05;
        });
    };
    EXPECT_GT(equivalent(0), 0.95);
    EXPECT_LE(equivalent(0.01), 0.07);  // at the margin: the level, 0.05
    EXPECT_LE(equivalent(-0.01), 0.07);
}

Images constant(int width, int height, double sum) {
    const auto n = static_cast<std::size_t>((width + 7) / 8 * ((height + 7) / 8));
    return Images(3, TileSums{.width = width, .height = height, .sums = std::vector(n, sum)});
}

TEST(TileTest, HasNoTestWhereThereIsNothingToTest) {
    const ImageTest black = test_tiles(constant(16, 16, 0), constant(16, 16, 0), {});
    EXPECT_EQ(black.strongest(), nullptr);
    EXPECT_EQ(black.p_value, 1);
    const ImageTest rounding = test_tiles(constant(16, 16, 64.001), constant(16, 16, 64), {});
    EXPECT_EQ(rounding.strongest(), nullptr);
    EXPECT_EQ(rounding.scales.back().equivalence_p, 0);  // exactly inside
}

TEST(TileTest, FindsADifferenceWithoutNoise) {
    Images other = constant(16, 16, 64);
    for (TileSums& image : other) image.sums[1] = 65;
    const ImageTest test = test_tiles(other, constant(16, 16, 64), {.is_paired = true});
    EXPECT_EQ(test.p_value, 0);
    EXPECT_EQ(test.strongest()->tile, (PixelRect{8, 0, 16, 8}));
    EXPECT_EQ(test.scales[0].tiles.size(), 1U);
    // Light where there is none.
    EXPECT_EQ(test_tiles(constant(8, 8, 1), constant(8, 8, 0), {}).p_value, 0);
}

TEST(TileTest, OfImagesThatAreNoMultipleOfATileAveragesOverWhatIsThere) {
    std::vector<float> rgb(3 * 37 * 21);
    std::iota(rgb.begin(), rgb.end(), 0.0F);
    const TileSums sums = tile_sums(37, 21, rgb);
    EXPECT_EQ(sums.sums.size(), 15U);
    // The corner: 5 × 5 pixels around (34, 18), whose mean is that pixel's, of its middle channel.
    EXPECT_NEAR(sums.sums.back() / 25, 3 * (18 * 37 + 34) + 1, 1e-9);
    Images images(3, sums);
    for (std::size_t i = 0; i < images.size(); ++i) {
        for (double& sum : images[i].sums) sum *= 1 + 0.1 * static_cast<double>(i);
    }
    const ImageTest test = test_tiles(images, images, {});
    ASSERT_EQ(test.scales.size(), 3U);  // 8, 32 and the image, which is smaller than 128
    EXPECT_EQ(test.scales[1].tiles.size(), 2U);
    EXPECT_EQ(test.scales[2].tiles.front().tile, (PixelRect{0, 0, 37, 21}));
    EXPECT_NEAR(test.scales[2].tiles.front().second, 1.1 * (3 * 37 * 21 - 1) / 2.0, 1e-6);
    EXPECT_EQ(test.p_value, 1);
}

TEST(TileTest, RefusesTooFewSeeds) {
    const Images two(2, TileSums{.width = 8, .height = 8, .sums = {1}});
    EXPECT_DEATH(test_tiles(two, two, {}), "check failed");
}

}  // namespace
}  // namespace misbench
