// Chains of factors in front of a heuristic's shares, and who of them learns from which pass.
#include "renderer/weights/weighting.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "renderer/weights/jendersie.h"
#include "renderer/weights/popov.h"
#include "tests/support/random_paths.h"
#include "tests/support/training.h"

namespace misbench {
namespace {

using test::gray;
using test::is_possible;
using test::RandomPaths;
using testing::ElementsAre;

class FixedFactors final : public FactorProvider {
 public:
    FixedFactors(Place place, std::vector<double> factors)
        : place_(place), factors_(std::move(factors)) {}
    Place place() const override { return place_; }
    void multiply(const PathView& /*path*/, const TechniqueCounts& /*counts*/,
                  std::span<double> factors) const override {
        for (std::size_t t = 0; t < factors.size(); ++t) factors[t] *= factors_[t];
    }

 private:
    Place place_;
    std::vector<double> factors_;
};
constexpr auto kDensities = FactorProvider::Place::Densities;
constexpr auto kShares = FactorProvider::Place::Shares;

// A path with the vertices that providers look at.
struct Seen {
    explicit Seen(const test::WeighedPath& path)
        : camera(static_cast<std::size_t>(path.n())),
          view{.densities = &path.densities, .pixel = {1, 0}, .camera = camera} {
        camera[0].point.position = {0, 0, 2};
    }
    std::vector<PathVertex> camera;
    PathView view;
};

class ChainOf : public testing::TestWithParam<std::string> {
 protected:
    // Of all techniques, each asked for on its own.
    std::vector<double> weights(const PathWeights& path_weights, const test::WeighedPath& path) {
        const Seen seen(path);
        std::vector<double> all;
        for (int t = 0; t < n_techniques(path.n()); ++t) {
            const auto weight =
                path_weights.weigh(seen.view, path.counts, technique_at(t, path.n()), scratch_);
            all.push_back(weight.w);
            if (weight.weights.empty()) continue;
            EXPECT_EQ(weight.weights[static_cast<std::size_t>(t)], weight.w);
            double sum = 0;
            for (const double w : weight.weights) sum += w;
            EXPECT_NEAR(sum, 1, 1e-10);
        }
        return all;
    }
    void expect_whole(const PathWeights& path_weights, const test::WeighedPath& path) {
        DensityScratch<double> scratch;
        const auto q = effective_densities(path.densities, path.counts, scratch);
        if (std::none_of(q.begin(), q.end(), [](double q_t) { return q_t > 0; })) return;
        double sum = 0;
        for (const double w : weights(path_weights, path)) {
            ASSERT_GE(w, 0);
            sum += w;
        }
        ASSERT_NEAR(sum, 1, 1e-10) << path.n() << " edges";
    }

    Heuristic heuristic_ = Heuristic::parse(GetParam());
    PathWeights::Scratch scratch_;
};

TEST_P(ChainOf, AnyFactorsMakesWeightsThatSumToOne) {
    RandomPaths random(41);
    for (int i = 0; i < 1500; ++i) {
        const int n = i % 100 == 0 ? 100 : 1 + i % 12;
        test::WeighedPath path = random.path(n, i % 4 == 0 ? 60 : 4, 0.2 / n, 0.5 / n);
        path.counts = random.counts();
        PathWeights path_weights(heuristic_);
        for (int j = 0; j < i % 5; ++j) {
            path_weights.add(std::make_shared<FixedFactors>(
                random.chance(0.5) ? kDensities : kShares, random.factors(n_techniques(n), 30)));
        }
        ASSERT_NO_FATAL_FAILURE(expect_whole(path_weights, path));
    }
}

// What learns has learned from samples of all techniques.
std::vector<std::shared_ptr<FactorProvider>> trained_providers() {
    std::mt19937 rng(8);
    std::lognormal_distribution<float> value(0, 3);
    test::TrainingPass pass;
    for (int i = 0; i < 4000; ++i) {
        const int n = 2 + i % 5;
        pass.push_back({{i % 3, 0},
                        n,
                        technique_at(static_cast<int>(rng() % unsigned(n_techniques(n))), n),
                        gray(value(rng)),
                        test::random_weights(n, rng)});
    }
    std::vector<std::shared_ptr<FactorProvider>> providers = {
        make_correlation({}), make_correlation({.bounded = false}), make_popov(), make_jendersie()};
    for (const auto& learner : {make_variance({}), make_variance({.variant = "hua2025"}),
                                make_variance({.factor = "reciprocal"}),
                                make_correction({.candidates = "1e-30,1e30", .filter = "none"}),
                                make_correction({.groups = "merge+light+nee+hit"})}) {
        test::Training(learner, 3, 1).pass(pass, true);
        providers.push_back(learner);
    }
    return providers;
}

TEST_P(ChainOf, ProvidersMakesWeightsThatSumToOne) {
    RandomPaths random(42);
    const auto providers = trained_providers();
    for (int i = 0; i < 1000; ++i) {
        const int n = i % 100 == 0 ? 100 : 1 + i % 12;
        test::WeighedPath path = random.path(n, i % 4 == 0 ? 60 : 4, 0.1 / n, 0.5 / n);
        path.counts = random.counts();
        PathWeights path_weights(heuristic_);
        for (const auto& provider : providers) {
            if (random.chance(0.3)) path_weights.add(provider);
        }
        ASSERT_NO_FATAL_FAILURE(expect_whole(path_weights, path));
    }
}

// w ∝ γ h(c ⊙ q), in whichever order they were added.                      [hua2025 Eq. 17, 18]
TEST_P(ChainOf, FactorsHasSomeBeforeTheHeuristicAndSomeBehind) {
    RandomPaths random(43);
    for (int i = 0; i < 200; ++i) {
        const int n = 2 + i % 6;
        test::WeighedPath path = random.path(n, 1);
        path.counts = {.light = 5, .connect = 1, .merge = 7};
        const auto c1 = random.factors(n_techniques(n), 1);
        const auto c2 = random.factors(n_techniques(n), 1);
        const auto g1 = random.factors(n_techniques(n), 1);
        const auto g2 = random.factors(n_techniques(n), 1);
        PathWeights path_weights(heuristic_);
        path_weights.add(std::make_shared<FixedFactors>(kShares, g1));
        path_weights.add(std::make_shared<FixedFactors>(kDensities, c1));
        path_weights.add(std::make_shared<FixedFactors>(kShares, g2));
        path_weights.add(std::make_shared<FixedFactors>(kDensities, c2));

        DensityScratch<double> scratch;
        const auto q = effective_densities(path.densities, path.counts, scratch);
        std::vector<double> expected(q.begin(), q.end());
        double largest = 0;
        for (std::size_t t = 0; t < q.size(); ++t) {
            expected[t] *= c1[t] * c2[t];
            largest = std::max(largest, expected[t]);
        }
        double sum = 0;
        for (std::size_t t = 0; t < q.size(); ++t) {
            const double u = expected[t] / largest;
            const std::string name = GetParam();
            double share = u;
            if (name == "power") share = u * u;
            if (name == "maximum") share = u == 1 ? 1 : 0;
            if (name == "cutoff") share = u < 0.1 ? 0 : u;
            if (name == "constant") share = u > 0 ? 1 : 0;
            sum += expected[t] = share * g1[t] * g2[t];
        }
        const std::vector<double> all = weights(path_weights, path);
        for (std::size_t t = 0; t < all.size(); ++t) {
            ASSERT_NEAR(all[t], expected[t] / sum, 1e-12) << GetParam() << ' ' << t;
        }
        const auto weight = path_weights.weigh(Seen(path).view, path.counts, {}, scratch_);
        for (std::size_t t = 0; t < all.size(); ++t) {
            if (weight.w == 0) break;
            const double product = c1[t] * c2[t] * g1[t] * g2[t];
            EXPECT_NEAR(weight.factors[t], product, 1e-12 * product);
        }
    }
}

std::vector<std::string> names_of_heuristics() {
    std::vector<std::string> names;
    for (const MisHeuristic& row : heuristics()) names.emplace_back(row.name);
    return names;
}
INSTANTIATE_TEST_SUITE_P(Heuristics, ChainOf, testing::ValuesIn(names_of_heuristics()),
                         [](const auto& row) { return row.param; });

// What the authors multiply a power of densities by is not raised itself.
TEST(Weighting, HasLearnedFactorsBehindTheHeuristic) {
    for (const auto& provider : make_factors({.factors = "variance+correction"})) {
        EXPECT_EQ(provider->place(), kShares);
    }
    for (const auto& provider : make_factors({.factors = "correlation+popov+jendersie"})) {
        EXPECT_EQ(provider->place(), kDensities);
    }
}

// Whether a sample at x_1 of two edges reaches who learns, pass by pass.
struct Pass {
    bool trains = false;
    bool is_watched = false;
    bool has_correction = false;
    bool has_variance = false;
    bool operator==(const Pass&) const = default;
};

std::vector<Pass> passes_of(const WeightParameters& parameters, int n) {
    ThreadPool threads(1);
    const Scene scene(test::open_box(), 1);
    Weighting weighting(parameters);
    weighting.start(scene, {.width = 1, .height = 1});
    const test::MadeUpSample made({}, 2, {TechniqueKind::Hit}, gray(1), 1);
    PathWeights::Scratch scratch;
    std::vector<Pass> passes;
    for (int i = 0; i < n; ++i) {
        Pass pass{.trains = weighting.is_training()};
        weighting.start_pass();
        pass.is_watched = weighting.is_watched();
        weighting.start_phase(1);
        weighting.weigh(made.path, {}, {TechniqueKind::Hit}, true, gray(float(1 + i)), 1, 0,
                        scratch);
        weighting.finish_phase();
        weighting.finish_pass(threads);
        nlohmann::json json;
        weighting.describe(json);
        pass.has_correction = json.contains("correction");
        pass.has_variance = json.contains("variance");
        passes.push_back(pass);
    }
    return passes;
}

TEST(Weighting, LearnsOneFactorAfterTheOther) {
    const Pass done = {.has_correction = true, .has_variance = true};
    WeightParameters parameters = {.factors = "correlation+correction+popov+variance",
                                   .training = 2};
    parameters.correction.groups = "hit";
    parameters.check();
    EXPECT_THAT(
        passes_of(parameters, 6),
        ElementsAre(Pass{true, true, false, false}, Pass{true, true, true, false},
                    Pass{true, true, true, false}, Pass{true, true, true, true}, done, done));
    Weighting weighting(parameters);
    EXPECT_TRUE(weighting.learns());
    EXPECT_EQ(weighting.n_precomputed_passes(), 0);
    parameters.precompute = 5;
    EXPECT_EQ(Weighting(parameters).n_precomputed_passes(), 10);
    EXPECT_EQ(Weighting({.precompute = 5}).n_precomputed_passes(), 0);
    EXPECT_FALSE(Weighting({.factors = "correlation+popov+jendersie"}).learns());
}

TEST(Weighting, LearnsWithoutEndIfAsked) {
    WeightParameters parameters = {.factors = "correction+variance"};
    parameters.correction.groups = "hit";
    parameters.variance.update = true;
    parameters.check();
    const Pass endless = {true, true, true, true};
    EXPECT_THAT(passes_of(parameters, 4),
                ElementsAre(Pass{true, true, true, false}, endless, endless, endless));
    parameters.factors = "variance+correction";
    EXPECT_EQ(test::refused(parameters), "factors");
}

// Samples that only an observer wants, and is shown.
class Counter final : public SampleObserver {
 public:
    explicit Counter(bool zeros) : zeros_(zeros) {}
    bool wants_zeros() const override { return zeros_; }
    void observe(const Sample& /*sample*/, std::size_t /*chunk*/) override { ++n_; }
    int n() const { return n_; }

 private:
    bool zeros_;
    int n_ = 0;
};

TEST(Weighting, ShowsZerosToThoseWhoWantThem) {
    for (const bool zeros : {false, true}) {
        WeightParameters parameters = {.factors = "variance"};
        parameters.variance.factor = "reciprocal";
        Counter counter(zeros);
        Weighting weighting(parameters);
        weighting.attach(counter);
        const Scene scene(test::open_box(), 1);
        weighting.start(scene, {.width = 1, .height = 1});
        weighting.start_pass();
        EXPECT_EQ(weighting.wants_zeros(), zeros);
        weighting.start_phase(1);
        const test::MadeUpSample made({}, 2, {}, {}, 1);
        PathWeights::Scratch scratch;
        weighting.weigh(made.path, {}, {}, true, {}, 1, 0, scratch);
        weighting.finish_phase();
        EXPECT_EQ(counter.n(), zeros ? 1 : 0);
        ThreadPool threads(1);
        weighting.finish_pass(threads);
        EXPECT_TRUE(weighting.maps().empty()) << "has learned from what it did not ask for";
    }
}

TEST(Weighting, RefusesWhatCannotBe) {
    using P = WeightParameters;
    EXPECT_EQ(test::refused(P{}), "");
    EXPECT_EQ(test::refused(P{.mis = "ballance"}), "mis");
    for (const std::string text : {"", "none+popov", "popov+", "popov,correlation", "correct"}) {
        EXPECT_EQ(test::refused(P{.factors = text}), "factors") << text;
    }
    EXPECT_EQ(test::refused(P{.training = 0}), "training");
    EXPECT_EQ(test::refused(P{.precompute = -1}), "precompute");
    EXPECT_EQ(test::refused(P{.correlation = {.scale = 0}}), "correlation_scale");
    EXPECT_EQ(test::refused(P{.variance = {.tile = 0}}), "variance_tile");
    EXPECT_EQ(test::refused(P{.correction = {.groups = "a"}}), "correction_groups");
}

}  // namespace
}  // namespace misbench
