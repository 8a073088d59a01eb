// Factors by second moments over variances: from samples that nobody traced, against sums of their
// own, tile by tile and pixel by pixel.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "renderer/weights/filters.h"
#include "renderer/weights/variance.h"
#include "tests/support/training.h"

namespace misbench {
namespace {

using test::gray;
using test::Training;
using test::TrainingPass;
using test::TrainingSample;
using testing::Each;
using testing::ElementsAre;

constexpr Technique kHit{TechniqueKind::Hit};
constexpr Technique kNextEvent{TechniqueKind::NextEvent};
constexpr Technique kLight{TechniqueKind::Light};
constexpr Technique kMerge1{TechniqueKind::Merge, 1};

Training training(VarianceParameters parameters, int width, int height) {
    parameters.check();
    return {make_variance(parameters), width, height};
}

// A pixel's sum over a technique's samples of one pass, and over their squares.
struct Estimate {
    double p = 0;
    double m = 0;
};
using Estimates = std::map<std::pair<int, int>, Estimate>;  // by (x, y)

Estimates estimates(const TrainingPass& pass, int n_edges, Technique technique) {
    Estimates all;
    for (const TrainingSample& sample : pass) {
        if (sample.n_edges != n_edges || !(sample.technique == technique)) continue;
        const double p = double{luminance(sample.value)};
        Estimate& estimate = all[{sample.pixel.x, sample.pixel.y}];
        estimate.p += p;
        estimate.m += p * p;
    }
    return all;
}
Estimate at(const Estimates& all, int x, int y) {
    const auto found = all.find({x, y});
    return found == all.end() ? Estimate{} : found->second;
}

// Mean and variance, value by value, by Welford's recurrence.
struct Welford {
    int n = 0;
    double mean = 0;
    double squares = 0;

    void add(double value) {
        ++n;
        const double before = value - mean;
        mean += before / n;
        squares += before * (value - mean);
    }
    double variance() const { return squares / (n - 1); }
};

std::vector<TrainingPass> random_passes(int n_passes, int width, int height, unsigned seed) {
    std::mt19937 rng(seed);
    std::lognormal_distribution<float> value(0, 1);
    std::vector<TrainingPass> passes(static_cast<std::size_t>(n_passes));
    for (TrainingPass& pass : passes) {
        for (int i = 0; i < 25 * width * height; ++i) {
            const int n = 1 + static_cast<int>(rng() % 4);
            const auto t = static_cast<int>(rng() % unsigned(n_techniques(n)));
            const Pixel pixel = {static_cast<int>(rng() % unsigned(width)),
                                 static_cast<int>(rng() % unsigned(height))};
            // Some vary less than others. Their weights do not matter.
            const float v = t % 2 == 0 ? value(rng) : 3 + 0.1F * value(rng);
            pass.push_back(
                {pixel, n, technique_at(t, n), {v, 0.5F * v, 2 * v}, test::random_weights(n, rng)});
        }
        pass.push_back({{0, 0}, 40, kHit, gray(1), {}});  // too long
    }
    return passes;
}

TEST(VarianceFactors, OfTilesAreThoseOfTheirPixels) {
    struct Case {
        int width, height, tile, n_passes;
    };
    for (const auto [width, height, tile, n_passes] : std::vector<Case>{{16, 8, 8, 1},
                                                                        {19, 9, 8, 1},
                                                                        {19, 9, 8, 3},
                                                                        {5, 4, 100, 1},
                                                                        {5, 4, 1, 4},
                                                                        {13, 7, 3, 2},
                                                                        {1, 1, 8, 5},
                                                                        {64, 1, 16384, 2}}) {
        const auto passes = random_passes(n_passes, width, height, 1);
        Training variance = training({.tile = tile}, width, height);
        variance.passes(passes);
        for (int n = 1; n <= 4; ++n) {
            for (int t = 0; t < n_techniques(n); ++t) {
                const Technique technique = technique_at(t, n);
                std::vector<Estimates> by_pass;
                for (const TrainingPass& pass : passes) {
                    by_pass.push_back(estimates(pass, n, technique));
                }
                for (int y = 0; y < height; ++y) {
                    for (int x = 0; x < width; ++x) {
                        Welford welford;
                        for (const Estimates& all : by_pass) {
                            for (int v = 0; v < height; ++v) {
                                for (int u = 0; u < width; ++u) {
                                    if (u / tile == x / tile && v / tile == y / tile) {
                                        welford.add(at(all, u, v).p);
                                    }
                                }
                            }
                        }
                        // 1 + μ² / σ²                                    [grittmann2019 Eq. 7]
                        double expected = 1;
                        if (n > 1 && welford.mean > 0) {
                            expected = 1 + welford.mean * welford.mean / welford.variance();
                        }
                        const double v = variance.factor({x, y}, n, technique);
                        ASSERT_NEAR(v, expected, 1e-4 * expected)
                            << width << 'x' << height << " by " << tile << ", pixel " << x << ' '
                            << y << ", technique " << t << " of " << n;
                    }
                }
            }
        }
        EXPECT_THAT(variance.factors({0, 0}, 40), Each(1));
    }
}

Plane filtered(Plane plane, int radius, int passes) {
    ThreadPool threads(1);
    box_filter(plane, radius, passes, threads);
    return plane;
}

// blur(M / V), M = blur(Σ p_i²), V = blur((p - b)²), b = blur(p), all means over the passes.
Plane blurred_factors(const std::vector<TrainingPass>& passes, int n_edges, Technique technique,
                      int width, int height, int radius, int blurs) {
    Plane p(width, height);
    Plane m(width, height);
    Plane spread(width, height);
    std::vector<Estimates> by_pass;
    for (const TrainingPass& pass : passes) by_pass.push_back(estimates(pass, n_edges, technique));
    const auto n = static_cast<float>(passes.size());
    const auto for_each_pixel = [&](const auto& visit) {
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                for (const Estimates& all : by_pass) {
                    visit(static_cast<std::size_t>(y * width + x), at(all, x, y));
                }
            }
        }
    };
    for_each_pixel([&](std::size_t i, Estimate estimate) {
        p.values[i] += static_cast<float>(estimate.p) / n;
        m.values[i] += static_cast<float>(estimate.m) / n;
    });
    const Plane b = filtered(p, radius, blurs);
    for_each_pixel([&](std::size_t i, Estimate estimate) {
        const float d = static_cast<float>(estimate.p) - b.values[i];
        spread.values[i] += d * d / n;
    });
    const Plane second = filtered(m, radius, blurs);
    const Plane variance = filtered(spread, radius, blurs);
    Plane factors(width, height, 1);
    for (std::size_t i = 0; i < factors.values.size(); ++i) {
        if (variance.values[i] > 0) factors.values[i] = second.values[i] / variance.values[i];
    }
    return filtered(factors, radius, blurs);
}

TEST(VarianceFactors, OfBlurredMomentsAreThoseOfADirectSum) {
    struct Case {
        const char* variant;
        int blur;  // as asked for
        int radius, blurs;
        bool (*has)(int n, Technique technique);
    };
    const auto merges = [](int, Technique t) { return t.kind == TechniqueKind::Merge; };
    const std::vector<Case> cases = {
        {"grittmann2021", 0, 4, 1, merges},
        {"grittmann2021", 2, 1, 2, merges},
        {"hua2025", 0, 1, 4,
         [](int n, Technique t) { return n == 2 || t.kind == TechniqueKind::Merge; }},
        {"hua2025-light", 0, 1, 4,
         [](int n, Technique t) {
             return t.kind == TechniqueKind::Merge || (n == 2 && t.kind == TechniqueKind::Light);
         }},
    };
    constexpr int kWidth = 14;
    constexpr int kHeight = 9;
    for (const Case& row : cases) {
        for (const int n_passes : {1, 3}) {
            const auto passes = random_passes(n_passes, kWidth, kHeight, 2);
            Training variance =
                training({.variant = row.variant, .blur = row.blur}, kWidth, kHeight);
            EXPECT_TRUE(variance.passes(passes).pixels.empty());
            for (int n = 1; n <= 4; ++n) {
                for (int t = 0; t < n_techniques(n); ++t) {
                    const Technique technique = technique_at(t, n);
                    const auto factors = variance.factor_image(n, technique);
                    if (n == 1 || !row.has(n, technique)) {
                        EXPECT_THAT(factors, Each(1)) << row.variant << ' ' << t << " of " << n;
                        continue;
                    }
                    const Plane expected = blurred_factors(passes, n, technique, kWidth, kHeight,
                                                           row.radius, row.blurs);
                    for (std::size_t i = 0; i < factors.size(); ++i) {
                        ASSERT_NEAR(factors[i], expected.values[i], 1e-4F * expected.values[i])
                            << row.variant << ' ' << t << " of " << n << " at " << i;
                    }
                }
            }
        }
    }
}

// All techniques, by the moment of the pixel.
TEST(VarianceFactors, OfAllTechniquesMayBeBlurredInstead) {
    constexpr int kSide = 12;
    const auto passes = random_passes(2, kSide, kSide, 3);
    Training variance = training({.blur = 3}, kSide, kSide);
    variance.passes(passes);
    // With one sample a pixel and pass both moments are the same.
    for (const double v : variance.factor_image(3, kNextEvent)) EXPECT_GT(v, 1);
    EXPECT_TRUE(variance.pass({}, true).pixels.empty());
}

TEST(VarianceFactors, AreOneWhereNothingIsKnown) {
    // A single value has no variance that could be known.
    const TrainingPass one = {{{0, 0}, 3, kHit, gray(2), {}}};
    for (const char* variant : {"grittmann2019", "grittmann2021", "hua2025"}) {
        for (const int blur : {0, 4}) {
            Training single = training({.variant = variant, .blur = blur}, 1, 1);
            TrainingPass pass = one;
            pass.push_back({{0, 0}, 3, kMerge1, gray(2), {}});
            single.pass(pass, true);
            EXPECT_THAT(single.factors({0, 0}, 3), Each(1)) << variant << blur;
        }
    }
    // The corner of an image that is one pixel larger than its tiles, and tiles of one pixel.
    for (const auto& [tile, size, pixel] :
         std::vector<std::tuple<int, int, Pixel>>{{8, 9, {8, 8}}, {1, 4, {2, 3}}}) {
        Training corner = training({.tile = tile}, size, size);
        corner.pass({{pixel, 3, kHit, gray(2), {}}}, true);
        EXPECT_EQ(corner.factor(pixel, 3, kHit), 1);
    }
    // Nothing was found, or only black.
    for (const TrainingPass& pass : {TrainingPass{}, TrainingPass{{{0, 0}, 3, kHit, {}, {}}}}) {
        for (const int blur : {0, 4}) {
            Training nothing = training({.blur = blur}, 9, 9);
            const Forgotten forgotten = nothing.pass(pass, true);
            EXPECT_THAT(nothing.factor_image(3, kHit), Each(1));
            EXPECT_THAT(forgotten.pixels, Each(0));
        }
    }
}

TEST(VarianceFactors, AreLargeAndFiniteWhereNothingVaries) {
    TrainingPass pass;
    for (int i = 0; i < 64; ++i) pass.push_back({{i % 8, i / 8}, 2, kHit, gray(0.7F), {}});
    for (const int blur : {0, 4}) {
        Training variance =
            training({.variant = blur > 0 ? "hua2025" : "grittmann2019", .blur = blur}, 8, 8);
        variance.passes({pass, pass});
        for (const double v : variance.factor_image(2, kHit)) {
            EXPECT_GT(v, 1e6);
            EXPECT_LT(v, 1.1e12);
        }
    }
}

TEST(VarianceFactors, StayFiniteNextToAFirefly) {
    constexpr int kWidth = 64;
    const TrainingPass plain = random_passes(1, kWidth, 1, 5)[0];
    for (const char* variant : {"grittmann2019", "grittmann2021", "hua2025"}) {
        for (const char* factor : {"ratio", "reciprocal"}) {
            // Something in the first of 16 passes.
            const auto factors = [&](const TrainingPass& more) {
                std::vector<TrainingPass> passes(16, plain);
                passes[0].insert(passes[0].end(), more.begin(), more.end());
                Training variance = training({.variant = variant, .factor = factor}, kWidth, 1);
                variance.passes(passes);
                return variance.factor_image(3, kMerge1);
            };
            const auto before = factors({});
            for (const float bad : {std::numeric_limits<float>::infinity(), std::nanf("")}) {
                EXPECT_EQ(factors({{{3, 0}, 3, kMerge1, gray(bad), {}}}), before)
                    << variant << " leaves out what is not finite";
            }
            // From 1.8e19 on the square is beyond floats, the mean square of the passes only later.
            for (const float bright : {1e12F, 1.8e19F, 2e19F, 6e19F, 1e30F, 3e38F}) {
                for (const std::size_t n_samples : {1U, 2U}) {
                    const TrainingSample firefly = {{3, 0}, 3, kMerge1, gray(bright), {}};
                    const auto after = factors(TrainingPass(n_samples, firefly));
                    for (std::size_t i = 0; i < kWidth; ++i) {
                        ASSERT_GT(after[i], 0) << variant << ' ' << factor << ' ' << bright;
                        ASSERT_LE(after[i], 1e30 * 1.001) << variant << ' ' << bright;
                        if (i < 16) continue;
                        ASSERT_EQ(after[i], before[i]) << variant << ' ' << bright;
                    }
                }
            }
        }
    }
}

TEST(VarianceFactors, MayBeReciprocalVariances) {
    std::mt19937 rng(6);
    std::normal_distribution<float> noise;
    TrainingPass pass;
    Welford hit;
    for (int i = 0; i < 64; ++i) {
        const float value = 10 + noise(rng);
        hit.add(double{luminance(gray(value))});
        pass.push_back({{i % 8, i / 8}, 3, kHit, gray(value), {}});
        pass.push_back({{i % 8, i / 8}, 3, kNextEvent, gray(1e-25F * value), {}});
    }
    Training variance = training({.factor = "reciprocal"}, 8, 16);
    variance.pass(pass, true);
    const double v = variance.factor({3, 3}, 3, kHit);
    EXPECT_NEAR(v, 1 / hit.variance(), 1e-4 * v);
    EXPECT_NEAR(variance.factor({3, 3}, 3, kNextEvent), 1e30, 1e25) << "the largest";
    // Least where nothing was found, in a tile or in the whole image, of such paths that it can
    // have seen.
    EXPECT_NEAR(variance.factor({3, 12}, 3, kHit), 1e-30, 1e-35);
    EXPECT_NEAR(variance.factor({3, 3}, 3, kLight), 1e-30, 1e-35);
    EXPECT_THAT(variance.factors({3, 3}, 11), Each(1)) << "longer than variance_max_depth";
    EXPECT_THAT(variance.factors({3, 3}, 1), Each(1));
}

TEST(VarianceFactors, ForgetTilesWithALargeOne) {
    // In the left tile nothing varies, in the middle one all, in the right one there is nothing.
    TrainingPass pass;
    for (int i = 0; i < 16; ++i) {
        pass.push_back({{i % 4, i / 4}, 2, kHit, gray(1), {}});
        pass.push_back({{4 + i % 4, i / 4}, 2, kHit, gray(i == 5 ? 7 : 0.1F), {}});
    }
    for (const double keep : {2.0, 1e30, 0.5}) {
        Training variance = training({.tile = 4, .keep = keep}, 11, 4);
        EXPECT_TRUE(variance.pass(pass, false).pixels.empty()) << "not before it has learned";
        const Forgotten forgotten = variance.pass(pass, true);
        EXPECT_FALSE(forgotten.all);
        ASSERT_EQ(forgotten.pixels.size(), 44U);
        for (std::size_t i = 0; i < 44; ++i) {
            const int expected = keep == 2 ? (i % 11 < 4 ? 1 : 0) : keep == 0.5 ? 1 : 0;
            EXPECT_EQ(forgotten.pixels[i], expected) << keep << ' ' << i;
        }
    }
}

TEST(VarianceFactors, LearnFromEveryPassIfAsked) {
    const auto passes = random_passes(3, 8, 8, 7);
    Training learning = training({.update = true}, 8, 8);
    EXPECT_TRUE(learning.provider().never_stops_learning());
    for (std::size_t n = 1; n <= passes.size(); ++n) {
        EXPECT_TRUE(learning.pass(passes[n - 1], n == 1).pixels.empty());
        Training once = training({}, 8, 8);
        once.passes({passes.begin(), passes.begin() + static_cast<std::ptrdiff_t>(n)});
        EXPECT_EQ(learning.factors({1, 1}, 4), once.factors({1, 1}, 4)) << n;
    }
    // Without it nothing is used before the last pass.
    Training waiting = training({}, 8, 8);
    EXPECT_FALSE(waiting.provider().never_stops_learning());
    waiting.pass(passes[0], false);
    EXPECT_THAT(waiting.factors({1, 1}, 4), Each(1));
}

TEST(VarianceFactors, AreShownByNameOfTechnique) {
    Training variance = training({.tile = 2}, 3, 2);
    TrainingPass pass;
    for (int i = 0; i < 4; ++i) {
        pass.push_back({{i % 2, i / 2}, 3, kMerge1, gray(i < 2 ? 1.0F : 3.0F), {}});
        pass.push_back({{i % 2, i / 2}, 2, kLight, gray(i < 2 ? 2.0F : 1.0F), {}});
    }
    variance.pass(pass, true);
    const std::vector<NamedImage> maps = variance.provider().maps();
    ASSERT_EQ(maps.size(), 2U);
    EXPECT_EQ(maps[0].name, "variance.n2.light");
    EXPECT_EQ(maps[1].name, "variance.n3.merge1");
    EXPECT_NEAR(maps[1].image.rgb[0], 1 + 4 / (4 / 3.0), 1e-5);
    EXPECT_EQ(maps[1].image.rgb[3 * 2], 1) << "the right tile";
    nlohmann::json json;
    variance.provider().describe(json);
    EXPECT_EQ(json["variance"]["techniques"], 2);
}

TEST(VarianceFactors, RefuseWhatCannotBe) {
    using P = VarianceParameters;
    EXPECT_EQ(test::refused(P{}), "");
    EXPECT_EQ(test::refused(P{.variant = "grittmann"}), "variance_variant");
    EXPECT_EQ(test::refused(P{.factor = ""}), "variance_factor");
    EXPECT_EQ(test::refused(P{.tile = 0}), "variance_tile");
    EXPECT_EQ(test::refused(P{.tile = 1 << 20}), "variance_tile");
    EXPECT_EQ(test::refused(P{.blur = -1}), "variance_blur");
    EXPECT_EQ(test::refused(P{.max_depth = 1}), "variance_max_depth");
    EXPECT_EQ(test::refused(P{.max_depth = 101}), "variance_max_depth");
    EXPECT_EQ(test::refused(P{.keep = std::nan("")}), "variance_keep");
    EXPECT_EQ(test::refused(P{.keep = -1}), "variance_keep");
}

}  // namespace
}  // namespace misbench
