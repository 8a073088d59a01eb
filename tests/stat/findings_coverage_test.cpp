// Findings are wrong as rarely as findings.h says, by simulation at the boundary of each rule,
// where a false finding is most likely. Normal errors, so that the intervals themselves are as good
// as exact; those of skewed errors are the subject of intervals_test. Every test has fixed seeds;
// thirteen comparisons with an upper limit at alpha = 0.001 for all together (Šidák: 3.79 standard
// errors for each, one-sided), chosen before they were first run.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "experiments/analysis/findings.h"

namespace misbench {
namespace {

constexpr int kTrials = 10'000;
constexpr int kSeeds = 5;
constexpr double kSpread = 0.05;
constexpr double kStandardErrors = 3.79;
constexpr double kOneEnd = (1 - kConfidence) / 2;

// Nothing beyond the rate of false findings and its standard error.
void expect_at_most(double rate, int n_false) {
    const double limit = rate + kStandardErrors * std::sqrt(rate * (1 - rate) / kTrials);
    EXPECT_LE(static_cast<double>(n_false) / kTrials, limit);
}

// One experiment: scenes of true ratios, with errors that share half of their variance between the
// scenes, as those of runs with the same random numbers may.
std::vector<LogRatio> drawn(std::mt19937_64& random, const std::vector<double>& truths) {
    std::normal_distribution<double> normal(0, kSpread / std::sqrt(2.0));
    std::vector<double> shared;
    for (int i = 0; i < 2 * kSeeds; ++i) shared.push_back(normal(random));
    std::vector<LogRatio> scenes;
    for (const double truth : truths) {
        std::vector<double> a;
        std::vector<double> b;
        for (std::size_t i = 0; i < kSeeds; ++i) {
            a.push_back(truth * (1 + shared[i] + normal(random)));
            b.push_back(1 + shared[kSeeds + i] + normal(random));
        }
        scenes.push_back(paired_log_ratio(a, b).value());
    }
    return scenes;
}

int count(const Claim& claim, Finding wanted, const std::vector<double>& truths) {
    std::mt19937_64 random(20250101);
    int n = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
        const Estimate ratio = combine(claim.over, drawn(random, truths)).ratio;
        n += judge(claim, ratio.interval.value()) == wanted ? 1 : 0;
    }
    return n;
}

Claim claim_of(ClaimOver over, Expectation expect) {
    Claim claim;
    claim.over = over;
    claim.expect = expect;
    return claim;
}

constexpr double kMost = 1 + kDefaultMargin;

TEST(Findings, OfOneSceneAreWrongAsRarelyAsTheySay) {
    const auto rate = [](Expectation expect, Finding finding, double truth) {
        expect_at_most(kOneEnd, count(claim_of(ClaimOver::Each, expect), finding, {truth}));
    };
    rate(Expectation::Less, Finding::Reproduced, 1);
    rate(Expectation::Less, Finding::NotReproduced, 1 / kMost);
    rate(Expectation::More, Finding::Reproduced, 1);
    rate(Expectation::More, Finding::NotReproduced, kMost);
    rate(Expectation::NotMore, Finding::Reproduced, kMost);
    rate(Expectation::NotMore, Finding::NotReproduced, kMost);
    rate(Expectation::Equal, Finding::Reproduced, kMost);
    rate(Expectation::Equal, Finding::NotReproduced, kMost);
}

// Twelve scenes at the limit: one of them often looks worse by chance, and the worst of them is
// not.
TEST(Findings, OfTheWorstSceneAreNotWrongBecauseThereAreMany) {
    const std::vector<double> all(12, kMost);
    const Claim claim = claim_of(ClaimOver::Worst, Expectation::NotMore);
    expect_at_most(kOneEnd, count(claim, Finding::NotReproduced, all));
    expect_at_most(kOneEnd, count(claim, Finding::Reproduced, all));
    // Only one scene is at the limit: then all depends on its upper end.
    std::vector<double> one(12, 0.5);
    one[7] = kMost;
    expect_at_most(kOneEnd, count(claim, Finding::Reproduced, one));
}

TEST(Findings, OfTheBestSceneAreNotWrongBecauseThereAreMany) {
    const Claim claim = claim_of(ClaimOver::Best, Expectation::Less);
    expect_at_most(kOneEnd, count(claim, Finding::Reproduced, std::vector<double>(12, 1)));
    std::vector<double> one(12, 2);
    one[3] = 1 / kMost;
    expect_at_most(kOneEnd, count(claim, Finding::NotReproduced, one));
}

// Rules that never decide would pass the tests above.
TEST(Findings, AreMadeWhereTheEffectIsLarge) {
    const std::vector<double> better(4, 0.7);
    for (const ClaimOver over : {ClaimOver::Mean, ClaimOver::Worst, ClaimOver::Best}) {
        EXPECT_GT(count(claim_of(over, Expectation::Less), Finding::Reproduced, better),
                  0.99 * kTrials);
        EXPECT_GT(count(claim_of(over, Expectation::More), Finding::NotReproduced, better),
                  0.99 * kTrials);
    }
}

}  // namespace
}  // namespace misbench
