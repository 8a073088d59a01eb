#include "renderer/mis/heuristics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "renderer/base/error.h"

namespace misbench {
namespace {

// Every row of the table with its default number, and the rows that take one with others.
std::vector<std::string> names_of_all() {
    std::vector<std::string> names;
    for (const MisHeuristic& row : heuristics()) {
        names.emplace_back(row.name);
        if (!row.parameter.empty()) names.push_back(std::string(row.name) + "0.5");
    }
    names.emplace_back("power7");
    return names;
}

class EveryHeuristic : public testing::TestWithParam<std::string> {
 protected:
    Heuristic heuristic_ = Heuristic::parse(GetParam());
};

std::vector<double> random_densities(std::mt19937_64& rng, double decades) {
    std::uniform_real_distribution<double> exponent(-decades / 2, decades / 2);
    std::vector<double> q(1 + rng() % 8);
    for (double& q_k : q) q_k = rng() % 4 == 0 ? 0 : std::pow(10.0, exponent(rng));
    q[rng() % q.size()] = std::pow(10.0, exponent(rng));
    return q;
}

double sum_of_weights(const Heuristic& heuristic, const std::vector<double>& q) {
    double sum = 0;
    for (std::size_t s = 0; s < q.size(); ++s) {
        if (q[s] > 0) sum += heuristic.weight(q, s);
    }
    return sum;
}

TEST_P(EveryHeuristic, HasWeightsThatSumToOneOverManyDecadesWithZeros) {
    std::mt19937_64 rng(1);
    for (const double decades : {1.0, 12.0, 60.0, 600.0}) {
        for (int i = 0; i < 2000; ++i) {
            const std::vector<double> q = random_densities(rng, decades);
            ASSERT_NEAR(sum_of_weights(heuristic_, q), 1, 1e-12) << testing::PrintToString(q);
        }
    }
}

TEST_P(EveryHeuristic, HasWeightsBetweenZeroAndOne) {
    std::mt19937_64 rng(2);
    for (int i = 0; i < 2000; ++i) {
        const std::vector<double> q = random_densities(rng, 40);
        for (std::size_t s = 0; s < q.size(); ++s) {
            if (q[s] == 0) continue;
            const double w = heuristic_.weight(q, s);
            ASSERT_TRUE(w >= 0 && w <= 1) << w << " of " << testing::PrintToString(q);
        }
    }
}

TEST_P(EveryHeuristic, DoesNotChangeWhenAllDensitiesAreScaled) {
    std::mt19937_64 rng(3);
    for (int i = 0; i < 500; ++i) {
        const std::vector<double> q = random_densities(rng, 12);
        std::vector<double> scaled = q;
        for (double& q_k : scaled) q_k *= 0x1p-500;
        for (std::size_t s = 0; s < q.size(); ++s) {
            if (q[s] > 0) {
                ASSERT_EQ(heuristic_.weight(q, s), heuristic_.weight(scaled, s));
            }
        }
    }
}

TEST_P(EveryHeuristic, GivesTheOnlyTechniqueAllTheWeight) {
    const std::vector<double> alone = {1e-200};
    EXPECT_EQ(heuristic_.weight(alone, 0), 1);
    const std::vector<double> others_impossible = {0, 1e200, 0};
    EXPECT_EQ(heuristic_.weight(others_impossible, 1), 1);
}

// ∫₀¹ x² dx = 1/3 with p₁ = 1 and p₂ = 2x, one sample each. The estimate's own variance gives the
// error; 4.5 σ is a chance of 7e-6 a row.
TEST_P(EveryHeuristic, IsUnbiasedOnAnIntegral) {
    std::mt19937_64 rng(4);
    std::uniform_real_distribution<double> uniform;
    const auto term = [this](double x, std::size_t s) {
        const std::vector<double> q = {1.0, 2 * x};
        return q[s] > 0 ? heuristic_.weight(q, s) * x * x / q[s] : 0;
    };
    constexpr int kSamples = 400'000;
    double mean = 0;
    double m2 = 0;
    for (int i = 1; i <= kSamples; ++i) {
        const double value = term(uniform(rng), 0) + term(std::sqrt(uniform(rng)), 1);
        const double delta = value - mean;
        mean += delta / i;
        m2 += delta * (value - mean);
    }
    EXPECT_NEAR(mean, 1.0 / 3, 4.5 * std::sqrt(m2 / kSamples / (kSamples - 1)));
}

INSTANTIATE_TEST_SUITE_P(Table, EveryHeuristic, testing::ValuesIn(names_of_all()),
                         [](const auto& test) {
                             std::string name = test.param;
                             for (char& c : name) c = c == '.' ? '_' : c;
                             return name;
                         });

TEST(Heuristic, FollowsItsFormula) {
    const std::vector<double> q = {1, 3, 4};
    EXPECT_DOUBLE_EQ(Heuristic::parse("balance").weight(q, 1), 3.0 / 8);
    EXPECT_DOUBLE_EQ(Heuristic::parse("power").weight(q, 1), 9.0 / 26);
    EXPECT_DOUBLE_EQ(Heuristic::parse("power3").weight(q, 2), 64.0 / 92);
    EXPECT_EQ(Heuristic::parse("maximum").weight(q, 2), 1);
    EXPECT_EQ(Heuristic::parse("maximum").weight(q, 1), 0);
    EXPECT_DOUBLE_EQ(Heuristic::parse("cutoff0.5").weight(q, 1), 3.0 / 7);
    EXPECT_EQ(Heuristic::parse("cutoff0.5").weight(q, 0), 0);
    EXPECT_EQ(Heuristic::parse("constant").weight(q, 0), 1.0 / 3);
}

TEST(Heuristic, WritesEveryHeuristicInOneWay) {
    EXPECT_EQ(Heuristic::parse("power").canonical_name(), "power2");
    EXPECT_EQ(Heuristic::parse("power2.0").canonical_name(), "power2");
    EXPECT_EQ(Heuristic::parse("power1.5").canonical_name(), "power1.5");
    EXPECT_EQ(Heuristic::parse("cutoff").canonical_name(), "cutoff0.1");
    EXPECT_EQ(Heuristic::parse("balance").canonical_name(), "balance");
}

TEST(Heuristic, RefusesWhatItDoesNotKnow) {
    for (const char* text : {"ballance", "", "balance2", "power-1", "power0", "powerx", "power2x",
                             "cutoff1", "cutoff0", "powernan", "powerinf"}) {
        EXPECT_THROW(Heuristic::parse(text), ParameterError) << text;
    }
    try {
        Heuristic::parse("ballance");
        FAIL();
    } catch (const ParameterError& e) {
        EXPECT_EQ(e.key(), "mis");
        EXPECT_THAT(e.what(), testing::HasSubstr("known: balance power maximum cutoff constant"));
    }
}

}  // namespace
}  // namespace misbench
