// The effective densities of a full path's techniques: against the table of path_densities.h,
// worked out by hand and by products of unlimited range. And those products themselves.
#include "renderer/paths/path_densities.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cfloat>
#include <cmath>
#include <limits>
#include <random>

#include "tests/support/random_paths.h"

namespace misbench {
namespace {

using testing::DoubleEq;
using testing::ElementsAre;

using test::by_the_table;
using test::LongProduct;
using test::RandomPaths;
using Path = test::WeighedPath;

struct Agreement {
    double worst = 0;        // relative difference
    std::size_t n_seen = 0;  // densities that were compared
};

// All q_t above `floor` against the table; others are at most a little above it.
template <class Real>
void compare_with_table(const Path& path, double floor, Agreement& agreement) {
    DensityScratch<Real> scratch;
    const std::span<const double> q = effective_densities(path.densities, path.counts, scratch);
    ASSERT_EQ(q.size(), static_cast<std::size_t>(n_techniques(path.n())));
    std::vector<LongProduct> expected;
    for (int t = 0; t < n_techniques(path.n()); ++t) {
        expected.push_back(by_the_table(path, technique_at(t, path.n())));
    }
    const LongProduct& largest = *std::max_element(expected.begin(), expected.end());
    for (std::size_t t = 0; t < q.size(); ++t) {
        ASSERT_TRUE(q[t] >= 0 && q[t] <= 1) << q[t];
        if (expected[t].significand == 0) {
            ASSERT_EQ(q[t], 0) << "technique " << t << " of " << path.n() << " edges";
            continue;
        }
        const auto ratio = static_cast<double>(expected[t].over(largest));
        if (ratio < floor) {
            ASSERT_LE(q[t], 1.001 * floor);
            continue;
        }
        const double difference = std::abs(q[t] / ratio - 1);
        agreement.worst = std::max(agreement.worst, difference);
        ++agreement.n_seen;
        ASSERT_LT(difference, 1) << "technique " << t << " of " << path.n() << " edges: " << q[t]
                                 << " instead of " << ratio;
    }
}

constexpr int kLengths[] = {1, 2, 3, 4, 5, 8, 13, 50, 300, 1000};

// Relative densities below this may become 0, near the least that a double can be.
constexpr double kLeast = 1e-300;

// 1,000 roundings to 53 bits are 4e-15 here, as they add up at random; 1e-13 at worst.
TEST(EffectiveDensities, AgreeWithTheTableOverSixHundredDecades) {
    RandomPaths random(1);
    Agreement agreement;
    for (const int n : kLengths) {
        for (const double decades : {0.01, 1.0, 10.0, 300.0}) {
            for (int i = 0; i < (n > 100 ? 8 : 200); ++i) {
                const bool dense = i % 2 == 0;
                Path path = random.path(n, decades, dense ? 0 : 0.3 / n,
                                        dense ? 0 : random.magnitude(1) / n);
                path.counts = random.counts();
                compare_with_table<double>(path, kLeast, agreement);
                if (HasFatalFailure()) return;
            }
        }
    }
    EXPECT_GT(agreement.n_seen, 50'000);
    EXPECT_LT(agreement.worst, 1e-12);
}

// 3e-6 here.
TEST(EffectiveDensities, OfFloatsAgreeWithTheTableWhileTheFactorsFit) {
    RandomPaths random(2);
    Agreement agreement;
    for (const int n : kLengths) {
        for (const double decades : {0.01, 1.0, 10.0, 30.0}) {
            for (int i = 0; i < (n > 100 ? 8 : 200); ++i) {
                Path path = random.path(n, decades, i % 2 * 0.3 / n, i % 2 * 0.5 / n);
                path.counts = random.counts();
                compare_with_table<float>(path, kLeast, agreement);
                if (HasFatalFailure()) return;
            }
        }
    }
    EXPECT_GT(agreement.n_seen, 50'000);
    EXPECT_LT(agreement.worst, 1e-4);
}

// C = 2 3 5 7, L = 11 13 17 19, p_nee = 23, π r² = 1/2.
Path example() {
    Path path;
    path.densities = {.from_camera = {0, 2, 3, 5, 7},
                      .from_light = {0, 11, 13, 17, 19},
                      .is_delta = {0, 0, 0, 0, 0},
                      .n_edges = 4,
                      .next_event = 23,
                      .merge_area = 0.5};
    path.counts = {
        .hit = 1, .nee = 2, .light = 100, .connect = 0.25, .merge = 40, .merge_first = true};
    return path;
}

std::vector<double> densities_of(const Path& path) {
    DensityScratch<double> scratch;
    const auto q = effective_densities(path.densities, path.counts, scratch);
    return {q.begin(), q.end()};
}

// In units of the largest, of light tracing.
std::vector<double> in_units(std::vector<double> q) {
    const double largest = *std::max_element(q.begin(), q.end());
    for (double& q_t : q) q_t /= largest;
    return q;
}
auto are_in_units(const std::vector<double>& q) {
    return testing::Pointwise(DoubleEq(), in_units(q));
}

TEST(EffectiveDensities, AreThoseOfAnExampleByHand) {
    //                                     hit   nee   light  connect 1, 2   merge 1, 2, 3
    EXPECT_THAT(densities_of(example()),
                are_in_units({210, 1380, 4618900, 2099.5, 484.5, 1847560, 503880, 193800}));
}

TEST(EffectiveDensities, CountTheCameraPathsThatShareTheFirstVertex) {
    Path path = example();
    path.counts.split = 3;
    EXPECT_THAT(densities_of(path),
                are_in_units({630, 4140, 4618900, 2099.5, 1453.5, 1847560, 1511640, 581400}));
    // Of two edges, next event estimation has no second vertex of its own.
    path.densities.n_edges = 2;
    EXPECT_THAT(densities_of(path), are_in_units({3 * 6, 2 * 23 * 2, 100 * 143, 20 * 2 * 143}));
}

TEST(EffectiveDensities, LeaveOutMergesAtTheFirstVertexUnlessAskedFor) {
    Path path = example();
    path.counts.merge_first = false;
    EXPECT_THAT(densities_of(path),
                are_in_units({210, 1380, 4618900, 2099.5, 484.5, 0, 503880, 193800}));
}

TEST(EffectiveDensities, AreZeroForTechniquesThatJoinAtADeltaVertex) {
    const auto with_delta = [](std::size_t i) {
        Path path = example();
        path.densities.is_delta[i] = 1;
        return densities_of(path);
    };
    EXPECT_THAT(with_delta(1), are_in_units({210, 1380, 0, 0, 484.5, 0, 503880, 193800}));
    EXPECT_THAT(with_delta(2), are_in_units({210, 1380, 4618900, 0, 0, 1847560, 0, 193800}));
    EXPECT_THAT(with_delta(3), are_in_units({210, 0, 4618900, 2099.5, 0, 1847560, 503880, 0}));
}

TEST(EffectiveDensities, OfOneEdgeAreThoseOfTheHitWhateverIsOff) {
    Path path = example();
    path.densities.n_edges = 1;
    EXPECT_THAT(densities_of(path), ElementsAre(1));
    path.counts = {.hit = 0, .nee = 0};
    EXPECT_THAT(densities_of(path), ElementsAre(1));
}

TEST(EffectiveDensities, AreAllZeroWhereNoTechniqueIsOn) {
    Path path = example();
    path.counts = {.hit = 0, .nee = 0};
    EXPECT_THAT(densities_of(path), testing::Each(0));
}

TEST(EffectiveDensities, DoNotDependOnWhatTheScratchHeldBefore) {
    RandomPaths random(3);
    DensityScratch<double> used;
    for (const int n : {1, 40, 3, 1, 2, 17, 400, 2}) {
        Path path = random.path(n, 20, 0.1, 0.2);
        path.counts = random.counts();
        const auto q = effective_densities(path.densities, path.counts, used);
        EXPECT_EQ(std::vector(q.begin(), q.end()), densities_of(path));
    }
}

TEST(Technique, HasAnIndexAndIsFoundByIt) {
    for (int n = 1; n < 20; ++n) {
        for (int index = 0; index < n_techniques(n); ++index) {
            EXPECT_EQ(technique_at(index, n).index(n), index);
        }
    }
    EXPECT_EQ(n_techniques(1), 1);
    EXPECT_EQ(n_techniques(2), 4);  // hit, nee, light, merge 1
    EXPECT_EQ(technique_at(3, 2), (Technique{TechniqueKind::Merge, 1}));
    EXPECT_EQ(technique_at(1, 4), (Technique{TechniqueKind::NextEvent, 0}));
    EXPECT_EQ(technique_at(3, 4), (Technique{TechniqueKind::Connect, 1}));
    EXPECT_EQ(technique_at(4, 4), (Technique{TechniqueKind::Connect, 2}));
    EXPECT_EQ(technique_at(5, 4), (Technique{TechniqueKind::Merge, 1}));
    EXPECT_EQ(technique_at(7, 4), (Technique{TechniqueKind::Merge, 3}));
}

template <class Real>
double log2_of(const ScaledProduct<Real>& product) {
    return std::log2(static_cast<double>(product.significand())) +
           static_cast<double>(product.exponent());
}

template <class Real>
class ScaledProductOf : public testing::Test {};
using Reals = testing::Types<double, float>;
TYPED_TEST_SUITE(ScaledProductOf, Reals);

TYPED_TEST(ScaledProductOf, TenThousandLargestNumbersDoesNotOverflow) {
    using Limits = std::numeric_limits<TypeParam>;
    ScaledProduct<TypeParam> product;
    for (int i = 0; i < 10'000; ++i) product *= Limits::max();
    // The largest number is 2^max_exponent (1 - ε/2).
    EXPECT_NEAR(log2_of(product), 1e4 * Limits::max_exponent, 0.01);
    for (int i = 0; i < 10'000; ++i) product *= 1 / Limits::max();
    EXPECT_NEAR(log2_of(product), 0, 0.01);
}

TYPED_TEST(ScaledProductOf, TenThousandSmallestNumbersIsExact) {
    using Limits = std::numeric_limits<TypeParam>;
    ScaledProduct<TypeParam> product;
    for (int i = 0; i < 10'000; ++i) product *= Limits::denorm_min();
    EXPECT_EQ(log2_of(product), 1e4 * (Limits::min_exponent - Limits::digits));
    EXPECT_EQ(std::frexp(product.significand(), std::make_unique<int>().get()), TypeParam(0.5));
}

TYPED_TEST(ScaledProductOf, LargestAndSmallestByTurnsStaysInRange) {
    using Limits = std::numeric_limits<TypeParam>;
    ScaledProduct<TypeParam> product(Limits::max());
    for (int i = 0; i < 1000; ++i) {
        product *= Limits::denorm_min();
        product *= Limits::max();
        product = product * ScaledProduct<TypeParam>(Limits::max());
        product = product * ScaledProduct<TypeParam>(Limits::denorm_min());
        ASSERT_TRUE(std::isfinite(product.significand()) && product.significand() > 0);
    }
    const double step = Limits::max_exponent + Limits::min_exponent - Limits::digits;
    EXPECT_NEAR(log2_of(product), Limits::max_exponent + 2000 * step, 0.01);
}

TYPED_TEST(ScaledProductOf, AZeroIsZeroForGood) {
    using Product = ScaledProduct<TypeParam>;
    Product product(std::numeric_limits<TypeParam>::max());
    product *= 0;
    for (int i = 0; i < 5; ++i) product *= std::numeric_limits<TypeParam>::max();
    EXPECT_TRUE(product.is_zero());
    EXPECT_TRUE((product * Product(2)).is_zero());
    EXPECT_TRUE((Product(2) * product).is_zero());
    EXPECT_TRUE(Product(0).is_zero());
    EXPECT_FALSE(Product().is_zero());
    EXPECT_FALSE(Product(std::numeric_limits<TypeParam>::denorm_min()).is_zero());
}

TYPED_TEST(ScaledProductOf, MultipliesAsItsFactorsDo) {
    RandomPaths random(4);
    for (int i = 0; i < 1000; ++i) {
        ScaledProduct<TypeParam> left;
        ScaledProduct<TypeParam> right;
        LongProduct expected;
        for (int j = 0; j < 20; ++j) {
            const auto factor = static_cast<TypeParam>(random.magnitude(35));
            (j % 3 == 0 ? left : right) *= factor;
            expected.multiply(double{factor});
        }
        ASSERT_NEAR(log2_of(left * right), expected.log2(),
                    40 * double{std::numeric_limits<TypeParam>::epsilon()} + 1e-12);
    }
}

}  // namespace
}  // namespace misbench
