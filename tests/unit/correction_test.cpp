// Correction factors: that the candidate chosen is the one of least moment, from samples whose
// moments are known.
#include "renderer/weights/correction.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "renderer/weights/filters.h"
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
constexpr Technique kMerge2{TechniqueKind::Merge, 2};

Training training(CorrectionParameters parameters, int width, int height) {
    parameters.check();
    return {make_correction(parameters), width, height};
}

// What a group has of a path's techniques, in words of the documentation.
bool is_in_group(const std::string& group, int n_edges, Technique technique) {
    if (group == "merge") return n_edges >= 3 && technique.kind == TechniqueKind::Merge;
    if (group == "light") return n_edges == 2 && technique.kind == TechniqueKind::Light;
    if (group == "nee") return technique.kind == TechniqueKind::NextEvent;
    return n_edges == 2 && technique.kind == TechniqueKind::Hit;
}
bool concerns(const std::string& group, int n_edges) {
    if (group == "merge") return n_edges >= 3;
    return group == "nee" ? n_edges >= 2 : n_edges == 2;
}

// F_γ of one pass and pixel: the value with the weights made anew.        [hua2025 Eq. 18, 22]
double corrected_value(const TrainingPass& pass, Pixel pixel, const std::string& group,
                       double gamma) {
    double sum = 0;
    for (const TrainingSample& sample : pass) {
        const int n = sample.n_edges;
        if (!(sample.pixel == pixel) || !concerns(group, n)) continue;
        double all = 0;
        double own = 0;
        for (int t = 0; t < n_techniques(n); ++t) {
            const double share = sample.weights[static_cast<std::size_t>(t)] *
                                 (is_in_group(group, n, technique_at(t, n)) ? gamma : 1);
            all += share;
            if (t == sample.technique.index(n)) own = share;
        }
        sum += own / all * double{sample.value.r + sample.value.g + sample.value.b} / 3;
    }
    return sum;
}

// M_γ by pixel, over the passes.                                               [hua2025 Eq. 23]
std::vector<double> moments(const std::vector<TrainingPass>& passes, int width, int height,
                            const std::string& group, double gamma) {
    std::vector<double> moments;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            double sum = 0;
            for (const TrainingPass& pass : passes) {
                sum += std::pow(corrected_value(pass, {x, y}, group, gamma), 2);
            }
            moments.push_back(sum / static_cast<double>(passes.size()));
        }
    }
    return moments;
}

std::vector<TrainingPass> random_passes(int n_passes, int width, int height, unsigned seed) {
    std::mt19937 rng(seed);
    std::lognormal_distribution<float> value(0, 1.5F);
    std::vector<TrainingPass> passes(static_cast<std::size_t>(n_passes));
    for (TrainingPass& pass : passes) {
        for (int i = 0; i < 12 * width * height; ++i) {
            const int n = 2 + static_cast<int>(rng() % 4);
            pass.push_back(
                {.pixel = {static_cast<int>(rng() % unsigned(width)),
                           static_cast<int>(rng() % unsigned(height))},
                 .n_edges = n,
                 .technique = technique_at(static_cast<int>(rng() % unsigned(n_techniques(n))), n),
                 .value = {value(rng), value(rng), value(rng)},
                 .weights = test::random_weights(n, rng)});
        }
    }
    return passes;
}

TEST(Correction, ChoosesTheCandidateOfLeastMoment) {
    constexpr int kWidth = 4;
    constexpr int kHeight = 3;
    const std::vector<double> candidates = {1, 0.01, 0.2, 0.5, 3, 40};
    const auto passes = random_passes(20, kWidth, kHeight, 1);
    for (const std::string group : {"merge", "light", "nee", "hit"}) {
        Training correction =
            training({.groups = group, .candidates = "0.01,0.2,0.5,3,40", .filter = "none"}, kWidth,
                     kHeight);
        correction.passes(passes);
        std::vector<std::vector<double>> of_candidates;
        for (const double gamma : candidates) {
            of_candidates.push_back(moments(passes, kWidth, kHeight, group, gamma));
        }
        std::vector<double> expected;
        for (std::size_t i = 0; i < kWidth * kHeight; ++i) {
            std::size_t best = 0;
            for (std::size_t c = 1; c < candidates.size(); ++c) {
                if (of_candidates[c][i] < of_candidates[best][i]) best = c;
            }
            expected.push_back(double{static_cast<float>(candidates[best])});
        }
        const NamedImage map = correction.provider().maps().at(0);
        EXPECT_EQ(map.name, "correction." + group);
        for (std::size_t i = 0; i < expected.size(); ++i) {
            EXPECT_EQ(double{map.image.rgb[3 * i]}, expected[i]) << group << ' ' << i;
        }
        // There is something to choose.
        EXPECT_NE(expected, std::vector<double>(expected.size(), expected[0])) << group;
    }
}

TEST(Correction, ComparesFilteredMomentsOverFilteredMeans) {
    constexpr int kWidth = 13;
    constexpr int kHeight = 6;
    const std::vector<double> candidates = {1, 0.05, 0.4, 5};
    const auto passes = random_passes(1, kWidth, kHeight, 2);
    ThreadPool threads(1);
    const auto filtered = [&](const std::vector<double>& values, int n) {
        Plane plane(kWidth, kHeight);
        for (std::size_t i = 0; i < values.size(); ++i) {
            plane.values[i] = static_cast<float>(values[i]);
        }
        box_filter(plane, 1, n, threads);
        return plane.values;
    };
    for (const std::string mean : {"candidate", "image"}) {
        Training correction = training({.groups = "merge",
                                        .candidates = "0.05,0.4,1,5",
                                        .mean = mean,
                                        .blur = 3,
                                        .blur_mean = 2,
                                        .blur_factor = 0},
                                       kWidth, kHeight);
        correction.passes(passes);
        std::vector<std::vector<double>> relative;
        for (const double gamma : candidates) {
            std::vector<double> means;
            const double of_mean = mean == "image" ? 1 : gamma;
            for (int i = 0; i < kWidth * kHeight; ++i) {
                means.push_back(
                    corrected_value(passes[0], {i % kWidth, i / kWidth}, "merge", of_mean));
            }
            const auto m2 = filtered(moments(passes, kWidth, kHeight, "merge", gamma), 3);
            const auto m1 = filtered(means, 2);
            relative.emplace_back();
            for (std::size_t i = 0; i < m1.size(); ++i) {
                relative.back().push_back(double{m2[i]} / std::pow(double{m1[i]}, 2));
            }
        }
        int n_compared = 0;
        for (std::size_t i = 0; i < kWidth * kHeight; ++i) {
            std::vector<std::pair<double, double>> order;
            for (std::size_t c = 0; c < candidates.size(); ++c) {
                order.emplace_back(relative[c][i], candidates[c]);
            }
            std::sort(order.begin(), order.end());
            if (order[1].first < 1.0001 * order[0].first) continue;  // rounding decides
            ++n_compared;
            const int x = static_cast<int>(i) % kWidth;
            const int y = static_cast<int>(i) / kWidth;
            EXPECT_EQ(correction.factor({x, y}, 3, kMerge2),
                      double{static_cast<float>(order[0].second)})
                << mean << ' ' << i;
        }
        EXPECT_GT(n_compared, 60);
    }
}

TEST(Correction, BlursTheFactors) {
    Training correction = training({.groups = "light",
                                    .candidates = "0.25",
                                    .mean = "image",
                                    .blur = 0,
                                    .blur_mean = 0,
                                    .blur_factor = 1},
                                   3, 1);
    // The light tracer's sample is much too bright in the left pixel.
    correction.pass({{{0, 0}, 2, kLight, gray(100), {0.3, 0.3, 0.4, 0}},
                     {{1, 0}, 2, kHit, gray(100), {0.3, 0.3, 0.4, 0}},
                     {{2, 0}, 2, kHit, gray(100), {0.3, 0.3, 0.4, 0}}},
                    true);
    EXPECT_THAT(correction.factor_image(2, kLight),
                ElementsAre(testing::DoubleNear(0.625, 1e-6), testing::DoubleNear(0.75, 1e-6), 1));
}

// Where no other technique finds the light, or the group none, no factor changes anything. The
// weights of three techniques rarely sum to one exactly.
TEST(Correction, KeepsOneWhereAllCandidatesAreTheSame) {
    constexpr int kSide = 24;
    std::mt19937 rng(3);
    std::exponential_distribution<float> value;
    TrainingPass pass;
    for (int i = 0; i < 8 * kSide * kSide; ++i) {
        const int k = 1 + i % 3;
        std::vector<double> weights(8, 0);
        double sum = 0;
        for (std::size_t t = 5; t < 8; ++t) sum += weights[t] = double{value(rng)};
        for (double& w : weights) w /= sum;
        pass.push_back({{i % kSide, i / kSide % kSide},
                        4,
                        {TechniqueKind::Merge, k},
                        gray(value(rng)),
                        weights});
        pass.push_back({{i % kSide, i / kSide % kSide}, 2, kLight, gray(value(rng)), {}});
        pass.push_back(
            {{i % kSide, i / kSide % kSide}, 2, kHit, gray(value(rng)), {0.7, 0.3, 0, 0}});
    }
    for (const std::string filter : {"none", "blur", "bilateral"}) {
        Training correction = training(
            {.candidates = "1e-30,1e-12,0.3,7", .filter = filter, .blur = 2, .blur_mean = 2}, kSide,
            kSide);
        correction.passes({pass, pass});
        EXPECT_THAT(correction.factor_image(4, kMerge2), Each(1)) << filter;
        EXPECT_THAT(correction.factor_image(2, kLight), Each(1)) << filter;
    }
}

TEST(Correction, KeepsOneWhereThereIsNoLight) {
    const std::vector<double> weights = {0.3, 0.3, 0.4, 0};
    for (const std::string filter : {"none", "blur", "bilateral"}) {
        Training correction = training(
            {.groups = "light", .filter = filter, .mean = "image", .blur_factor = 0}, 40, 1);
        correction.pass({{{0, 0}, 2, kLight, gray(1), weights}}, true);
        const std::vector<double> factors = correction.factor_image(2, kLight);
        EXPECT_LT(factors[0], 1) << filter;
        for (std::size_t i = 20; i < 40; ++i) EXPECT_EQ(factors[i], 1) << filter;
    }
    Training nothing = training({}, 5, 5);
    nothing.pass({}, true);
    EXPECT_THAT(nothing.factors({2, 2}, 4), Each(1));
    EXPECT_TRUE(nothing.provider().maps().empty());
    nlohmann::json json;
    nothing.provider().describe(json);
    EXPECT_TRUE(json.empty());
    // Samples without a value are no light.
    Training zeros = training({.groups = "light"}, 5, 5);
    zeros.pass({{{2, 2}, 2, kLight, {}, weights}}, true);
    EXPECT_THAT(zeros.factors({2, 2}, 2), Each(1));
}

TEST(Correction, OfTheOtherPixelsSurvivesAFirefly) {
    constexpr int kWidth = 64;
    const auto factors = [&](const std::string& filter, const TrainingPass& more) {
        TrainingPass pass = random_passes(1, kWidth, 1, 4)[0];
        pass.insert(pass.end(), more.begin(), more.end());
        Training correction = training({.candidates = "1e-30,0.01,0.1,0.5,1e30",
                                        .filter = filter,
                                        .blur = 4,
                                        .blur_mean = 4,
                                        .blur_factor = 4},
                                       kWidth, 1);
        correction.pass(pass, true);
        return correction.factor_image(3, kMerge2);
    };
    const std::vector<double> even(6, 1.0 / 6);
    for (const std::string filter : {"none", "blur", "bilateral"}) {
        const std::vector<double> before = factors(filter, {});
        for (const float bad : {std::numeric_limits<float>::infinity(), std::nanf("")}) {
            EXPECT_EQ(factors(filter, {{{9, 0}, 3, kMerge2, gray(bad), even}}), before)
                << "what is not finite is left out";
        }
        for (const float bright : {1e12F, 1e30F, 3e38F}) {
            const auto after = factors(filter, {{{9, 0}, 3, kMerge2, gray(bright), even},
                                                {{9, 0}, 3, kHit, gray(bright), even}});
            for (const double c : after) {
                ASSERT_GT(c, 0) << filter << ' ' << bright;
                ASSERT_LE(c, 1.01e30);
            }
            for (std::size_t i = 20; i < kWidth; ++i) EXPECT_EQ(after[i], before[i]) << bright;
        }
    }
}

TEST(Correction, MultipliesItsTechniquesInItsPixelOnly) {
    Training correction =
        training({.groups = "merge+light+nee", .candidates = "0.5", .filter = "none"}, 2, 1);
    const std::vector<double> three(6, 1.0 / 6);
    const std::vector<double> two(4, 0.25);
    EXPECT_THAT(correction.factors({}, 3), Each(1)) << "before it has learned";
    correction.pass({{{1, 0}, 3, kMerge2, gray(9), three}, {{1, 0}, 2, kLight, gray(9), two}},
                    true);
    for (const int n : {1, 2, 3, 7}) EXPECT_THAT(correction.factors({0, 0}, n), Each(1));
    EXPECT_THAT(correction.factors({1, 0}, 1), ElementsAre(1));
    EXPECT_THAT(correction.factors({1, 0}, 2), ElementsAre(1, 1, 0.5, 1));
    EXPECT_THAT(correction.factors({1, 0}, 3), ElementsAre(1, 1, 1, 1, 0.5, 0.5));
    EXPECT_THAT(correction.factors({1, 0}, 5), ElementsAre(1, 1, 1, 1, 1, 1, 0.5, 0.5, 0.5, 0.5));
}

TEST(Correction, DropsTheSamplesOfTrainingOnlyIfAsked) {
    for (const bool keep : {true, false}) {
        Training correction = training({.keep = keep}, 2, 2);
        EXPECT_FALSE(correction.pass({}, false).all);
        const Forgotten forgotten = correction.pass({}, true);
        EXPECT_EQ(forgotten.all, !keep);
        EXPECT_TRUE(forgotten.pixels.empty());
    }
}

// Two surfaces side by side: only on the left one the light tracer is bad.
TEST(Correction, ByBilateralFilterDoesNotMixSurfaces) {
    constexpr int kSide = 16;
    TrainingPass pass;
    for (int i = 0; i < kSide * kSide; ++i) {
        const Pixel pixel = {i % kSide, i / kSide};
        const bool is_left = pixel.x < kSide / 2;
        pass.push_back({pixel, 2, is_left ? kHit : kLight, gray(1), {0.5, 0, 0.5, 0}});
        if (i % 5 == 0) {
            pass.push_back({pixel, 2, is_left ? kLight : kHit, gray(30), {0.5, 0, 0.5, 0}});
        }
        // What tells the surfaces apart comes from camera paths.
        pass.push_back({pixel, 3, kHit, gray(1e-6F), {}});
    }
    Training correction =
        training({.groups = "light", .candidates = "0.125,8", .filter = "bilateral"}, kSide, kSide);
    correction.pass(pass, true, [](test::MadeUpSample& made) {
        if (made.camera.empty()) return;
        const float d = made.path.pixel.x < kSide / 2 ? 1 : 2;
        made.camera[0].point.position = {d, 0, 0};
        made.camera[0].point.normal = {-1, 0, 0};
    });
    for (int i = 0; i < kSide * kSide; ++i) {
        const Pixel pixel = {i % kSide, i / kSide};
        EXPECT_EQ(correction.factor(pixel, 2, kLight), pixel.x < kSide / 2 ? 0.125 : 8) << i;
    }
}

// As many as a precomputation has: what is added last counts as much as what was first.
TEST(Correction, SumsOverManyPasses) {
    Training correction =
        training({.groups = "light", .candidates = "0.5", .filter = "none"}, 1, 1);
    // Alike for both candidates, and so large that its square leaves no digits for the others' in
    // single precision.
    correction.pass({{{0, 0}, 2, kHit, gray(4000), {1, 0, 0, 0}}});
    constexpr int kPasses = 20'000;
    for (int i = 1; i <= kPasses; ++i) {
        correction.pass({{{0, 0}, 2, kLight, gray(1), {0.5, 0, 0.5, 0}}}, i == kPasses);
    }
    EXPECT_EQ(correction.factor({0, 0}, 2, kLight), 0.5);
}

TEST(Correction, RefusesWhatCannotBe) {
    using P = CorrectionParameters;
    EXPECT_EQ(test::refused(P{}), "");
    EXPECT_EQ(test::refused(P{.candidates = "1e-5,1,2.5e4"}), "");
    for (const std::string text : {"", ",", "0.1,", "0.1,,1", "0", "-0.5", "a", "0.1 0.2", "inf",
                                   "nan", "0.1;1", "1e-40", "1e40", "1e-400", "0x1p3"}) {
        EXPECT_EQ(test::refused(P{.candidates = text}), "correction_candidates") << text;
    }
    std::string many = "0.5";
    for (int i = 0; i < 200; ++i) many += ",0.5";
    EXPECT_EQ(test::refused(P{.candidates = many}), "correction_candidates");
    for (const std::string text : {"", "merge+", "connect", "merge,light", "merge+merge"}) {
        EXPECT_EQ(test::refused(P{.groups = text}), "correction_groups") << text;
    }
    EXPECT_EQ(test::refused(P{.filter = "gauss"}), "correction_filter");
    EXPECT_EQ(test::refused(P{.filter = ""}), "correction_filter");
    EXPECT_EQ(test::refused(P{.mean = ""}), "correction_mean");
    EXPECT_EQ(test::refused(P{.blur = -1}), "correction_blur");
    EXPECT_EQ(test::refused(P{.blur_mean = 5000}), "correction_blur_mean");
    EXPECT_EQ(test::refused(P{.blur_factor = -1}), "correction_blur_factor");
}

}  // namespace
}  // namespace misbench
