// What claims come to: the rules, and the same on stores with made-up runs. The claims are about
// seconds a pass, which made-up records say directly.
#include "experiments/analysis/findings.h"

#include <gmock/gmock.h>

#include "tests/support/store_fixture.h"

namespace misbench {
namespace {

using testing::HasSubstr;

const Budget kBudget = SampleBudget{16};

Claim claim_of(Expectation expect, ClaimOver over = ClaimOver::Each) {
    return {.text = "said",
            .where = "Fig. 1",
            .scenes = {"A", "B"},
            .method = "clever",
            .against = "plain",
            .metric = kSecondsPerPass,
            .budget = kBudget,
            .over = over,
            .expect = expect,
            .note = ""};
}

TEST(Findings, FollowFromTheIntervalByTheRulesOfTheHeader) {
    const auto finding = [](Expectation expect, double low, double high) {
        return judge(claim_of(expect), {low, high});
    };
    constexpr Finding kYes = Finding::Reproduced;
    constexpr Finding kNo = Finding::NotReproduced;
    constexpr Finding kOpen = Finding::NotDecided;
    EXPECT_EQ(finding(Expectation::Less, 0.5, 0.99), kYes);
    EXPECT_EQ(finding(Expectation::Less, 0.97, 0.99), kYes);
    EXPECT_EQ(finding(Expectation::Less, 0.9, 1.01), kOpen);
    EXPECT_EQ(finding(Expectation::Less, 0.9, 1.5), kOpen);
    EXPECT_EQ(finding(Expectation::Less, 0.96, 1.01), kNo);  // less by 4 % at most
    EXPECT_EQ(finding(Expectation::Less, 1.01, 1.5), kNo);

    EXPECT_EQ(finding(Expectation::More, 1.01, 2), kYes);
    EXPECT_EQ(finding(Expectation::More, 0.99, 1.1), kOpen);
    EXPECT_EQ(finding(Expectation::More, 0.99, 1.04), kNo);
    EXPECT_EQ(finding(Expectation::More, 0.5, 0.9), kNo);

    EXPECT_EQ(finding(Expectation::NotMore, 0.5, 1.04), kYes);
    EXPECT_EQ(finding(Expectation::NotMore, 1.01, 1.04), kYes);
    EXPECT_EQ(finding(Expectation::NotMore, 1.01, 1.06), kOpen);
    EXPECT_EQ(finding(Expectation::NotMore, 1.06, 1.2), kNo);

    EXPECT_EQ(finding(Expectation::NotLess, 0.96, 2), kYes);
    EXPECT_EQ(finding(Expectation::NotLess, 0.94, 2), kOpen);
    EXPECT_EQ(finding(Expectation::NotLess, 0.5, 0.94), kNo);

    EXPECT_EQ(finding(Expectation::Equal, 0.96, 1.04), kYes);
    EXPECT_EQ(finding(Expectation::Equal, 0.94, 1.04), kOpen);
    EXPECT_EQ(finding(Expectation::Equal, 0.96, 1.06), kOpen);
    EXPECT_EQ(finding(Expectation::Equal, 1.06, 1.2), kNo);
    EXPECT_EQ(finding(Expectation::Equal, 0.8, 0.94), kNo);
}

TEST(Findings, OfAWiderMarginAskForLess) {
    Claim claim = claim_of(Expectation::NotMore);
    claim.margin = 0.2;
    EXPECT_EQ(judge(claim, {0.9, 1.19}), Finding::Reproduced);
    EXPECT_EQ(judge(claim, {0.9, 1.21}), Finding::NotDecided);
}

TEST(Findings, OfTheWorstAndTheBestTakeTheEndsThatTheHeaderSays) {
    const auto at = [](double ratio) {
        return LogRatio{.value = std::log(ratio),
                        .variance = 0.01,
                        .degrees_of_freedom = 4,
                        .why_none = std::nullopt};
    };
    const std::vector<LogRatio> scenes = {at(0.5), at(2), at(1)};
    const double shared = 1 - 0.05 / 3;
    const Interval alone = to_ratio(at(2)).interval.value();
    const Interval among = to_ratio(at(2), shared).interval.value();
    const OverScenes worst = combine(ClaimOver::Worst, scenes);
    EXPECT_EQ(worst.scene, 1U);
    EXPECT_DOUBLE_EQ(worst.ratio.value, 2);
    EXPECT_DOUBLE_EQ(worst.ratio.interval->high, alone.high);
    EXPECT_DOUBLE_EQ(worst.ratio.interval->low, among.low);
    const OverScenes best = combine(ClaimOver::Best, scenes);
    EXPECT_EQ(best.scene, 0U);
    EXPECT_DOUBLE_EQ(best.ratio.value, 0.5);
    EXPECT_DOUBLE_EQ(best.ratio.interval->low, 1 / alone.high);
    EXPECT_DOUBLE_EQ(best.ratio.interval->high, 1 / among.low);
    EXPECT_NEAR(combine(ClaimOver::Mean, scenes).ratio.value, 1, 1e-12);
}

class FindingsTest : public testing::Test {
 protected:
    // Runs of both methods in scenes A and B, whose seconds a pass `seconds_of` says.
    std::vector<ClaimFinding> findings(const std::vector<Claim>& claims, int n_seeds,
                                       const auto& seconds_of, const auto& is_run) {
        Plan plan = made_up_plan("exp", n_seeds, kBudget);
        std::erase_if(plan.cells, [](const Cell& cell) { return cell.role != Role::Test; });
        std::vector<Cell> both;
        for (const char* scene : {"A", "B"}) {
            for (Cell cell : plan.cells) {
                cell.scene = cell.task.scene = scene;
                cell.task.scene_hash = sha256_hex(scene);
                both.push_back(cell);
            }
        }
        plan.cells = both;
        plan.scenes = {{.name = "A", .exposure = 0}, {.name = "B", .exposure = 0}};
        plan.claims = claims;
        Store store(temporary_.path() / "store", Store::Access::ReadWrite);
        store.put_experiment(plan);
        for (const Cell& cell : plan.cells) {
            if (!is_run(cell)) continue;
            commit_made_up_run(store, cell.task, [&](Record& record) {
                record.statistics.passes = 10;
                record.statistics.cpu_seconds = 10 * seconds_of(cell);
            });
        }
        return judge_claims(store, store.experiment("exp"));
    }

    std::vector<ClaimFinding> findings(const std::vector<Claim>& claims, int n_seeds,
                                       const auto& seconds_of) {
        return findings(claims, n_seeds, seconds_of, [](const Cell&) { return true; });
    }

    // Half the time in A, 1.2 times in B, with a noise of 2 %.
    static double half_and_more(const Cell& cell) {
        const double noise = cell.seed % 2 == 0 ? 1.02 : 0.98;
        if (cell.method == "plain") return 1;
        return (cell.scene == "A" ? 0.5 : 1.2) * noise;
    }

 private:
    TemporaryFolder temporary_;
};

TEST_F(FindingsTest, OverEachSceneIsALineForEach) {
    Claim claim = claim_of(Expectation::Less);
    claim.paper = {{"A", 0.5}, {"B", 0.9}};
    const auto found = findings({claim}, 6, half_and_more);
    ASSERT_EQ(found.size(), 2U);
    EXPECT_EQ(found[0].scene, "A");
    EXPECT_EQ(found[0].finding, Finding::Reproduced);
    EXPECT_NEAR(found[0].ratio->value, 0.5, 1e-9);
    EXPECT_EQ(found[0].n_seeds, 6);
    EXPECT_TRUE(found[0].is_paired);
    EXPECT_EQ(found[0].agrees_with_paper(), true);
    EXPECT_EQ(found[0].reason, "");
    EXPECT_EQ(found[1].finding, Finding::NotReproduced);
    EXPECT_EQ(found[1].agrees_with_paper(), false);
}

TEST_F(FindingsTest, OverAllScenesIsOneLineThatNamesTheWorstOrTheBest) {
    Claim best = claim_of(Expectation::Less, ClaimOver::Best);
    best.paper = {{"", 0.5}};
    const auto found = findings({claim_of(Expectation::NotMore, ClaimOver::Worst), best,
                                 claim_of(Expectation::Less, ClaimOver::Mean)},
                                6, half_and_more);
    ASSERT_EQ(found.size(), 3U);
    EXPECT_EQ(found[0].scene, "B");
    EXPECT_EQ(found[0].finding, Finding::NotReproduced);
    EXPECT_EQ(found[1].scene, "A");
    EXPECT_EQ(found[1].finding, Finding::Reproduced);
    EXPECT_EQ(found[1].agrees_with_paper(), true);
    EXPECT_EQ(found[2].scene, "");
    EXPECT_NEAR(found[2].ratio->value, std::sqrt(0.5 * 1.2), 1e-9);
    EXPECT_EQ(found[2].finding, Finding::Reproduced);
}

TEST_F(FindingsTest, AClaimThatFailsForWantOfADifferenceSaysSo) {
    const auto found = findings({claim_of(Expectation::Less)}, 6, [](const Cell& cell) {
        return cell.method == "plain" ? 1.0 : cell.seed % 2 == 0 ? 1.01 : 0.99;
    });
    EXPECT_EQ(found[0].finding, Finding::NotReproduced);
    EXPECT_EQ(found[0].reason, "any difference is below the margin");
}

TEST_F(FindingsTest, WhatIsOpenSaysHowManySeedsMayDecide) {
    const auto noisy = [](const Cell& cell) {
        if (cell.method == "plain") return 1.0;
        return 0.9 * (cell.seed % 2 == 0 ? 1.2 : 0.8);
    };
    const auto found = findings({claim_of(Expectation::Less)}, 6, noisy);
    EXPECT_EQ(found[0].finding, Finding::NotDecided);
    // The spread of the mean's logarithm is 0.22/√n: that of 22 seeds is 0.1/2.08.
    ASSERT_TRUE(found[0].more_seeds);
    EXPECT_NEAR(*found[0].more_seeds, 22 - 6, 3);
}

TEST_F(FindingsTest, OnTheBoundaryNoNumberOfSeedsIsSaid) {
    const auto wild = [](const Cell& cell) {
        return cell.method == "plain" ? 1.0 : cell.seed % 2 == 0 ? 1.9 : 0.1;
    };
    const auto found = findings({claim_of(Expectation::Less)}, 6, wild);
    EXPECT_EQ(found[0].finding, Finding::NotDecided);
    EXPECT_EQ(found[0].more_seeds, std::nullopt);
}

TEST_F(FindingsTest, TwoSeedsDecideNothing) {
    const auto found = findings({claim_of(Expectation::Less)}, 2, half_and_more);
    EXPECT_EQ(found[0].finding, Finding::NotDecided);
    EXPECT_EQ(found[0].reason, "fewer than 3 seeds");
    EXPECT_EQ(found[0].more_seeds, 1);
    EXPECT_TRUE(found[0].ratio);
}

TEST_F(FindingsTest, NothingIsSaidWhereAPlannedRunIsMissing) {
    const auto found = findings(
        {claim_of(Expectation::Less), claim_of(Expectation::Less, ClaimOver::Mean)}, 6,
        half_and_more, [](const Cell& cell) { return cell.scene == "A" || cell.seed != 4; });
    EXPECT_EQ(found[0].finding, Finding::Reproduced);
    EXPECT_EQ(found[1].finding, Finding::NotMeasured);
    EXPECT_EQ(found[1].reason, "B, clever: 5 of 6 seeds: 1 unfinished");
    EXPECT_EQ(found[1].n_seeds, 5);
    EXPECT_TRUE(found[1].ratio);
    EXPECT_EQ(found[2].finding, Finding::NotMeasured);
    const auto none = findings({claim_of(Expectation::Less)}, 7, half_and_more,
                               [](const Cell& cell) { return cell.method == "plain"; });
    EXPECT_EQ(none[0].finding, Finding::NotMeasured);
}

TEST_F(FindingsTest, TheSameInEverySeedIsARatioOfOneWithoutDoubt) {
    const auto same = [](const Cell& cell) { return 1 + 0.1 * static_cast<double>(cell.seed); };
    const auto found = findings({claim_of(Expectation::Equal), claim_of(Expectation::Less),
                                 claim_of(Expectation::NotMore, ClaimOver::Worst)},
                                3, same);
    EXPECT_EQ(found[0].finding, Finding::Reproduced);
    EXPECT_THAT(found[0].reason, HasSubstr("bit by bit"));
    EXPECT_EQ(found[2].finding, Finding::NotReproduced);
    EXPECT_EQ(found[4].finding, Finding::Reproduced);
}

TEST_F(FindingsTest, AProportionWithoutSpreadIsNotDecided) {
    const auto found =
        findings({claim_of(Expectation::Less), claim_of(Expectation::Less, ClaimOver::Worst)}, 3,
                 [](const Cell& cell) { return cell.method == "plain" ? 2.0 : 1.0; });
    for (const ClaimFinding& finding : found) {
        EXPECT_EQ(finding.finding, Finding::NotDecided);
        EXPECT_EQ(finding.reason, to_string(NoInterval::NoSpread));
        EXPECT_EQ(finding.more_seeds, std::nullopt);
    }
}

TEST_F(FindingsTest, HeavyTailsAreMarked) {
    const auto found = findings({claim_of(Expectation::Less)}, 5, [](const Cell& cell) {
        return cell.method == "clever" && cell.scene == "B" && cell.seed > 3 ? 9.0 : 1.0;
    });
    EXPECT_FALSE(found[0].has_heavy_tail);
    EXPECT_TRUE(found[1].has_heavy_tail);
    EXPECT_TRUE(found[1].ratio->interval);
}

TEST_F(FindingsTest, OneSeedThatCarriesTheErrorDecidesNothing) {
    const auto with_spike = [](const Cell& cell) {
        const double error = half_and_more(cell);
        return cell.method == "plain" && cell.scene == "B" && cell.seed == 3 ? 20 * error : error;
    };
    const auto found = findings(
        {claim_of(Expectation::Less), claim_of(Expectation::Less, ClaimOver::Mean)}, 6, with_spike);
    EXPECT_TRUE(found[0].ratio->interval);
    for (const std::size_t i : {1U, 2U}) {
        EXPECT_EQ(found[i].finding, Finding::NotDecided);
        EXPECT_FALSE(found[i].ratio->interval);
        EXPECT_EQ(found[i].reason, to_string(NoInterval::HeavyTail));
        EXPECT_EQ(found[i].more_seeds, std::nullopt);
    }
}

}  // namespace
}  // namespace misbench
