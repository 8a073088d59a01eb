// Error against effort and against a parameter, from a made-up store: what is a point, what is said
// of it, and what is asked for in vain.
#include "experiments/analysis/tradeoff.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "experiments/analysis/noisy_reference.h"
#include "experiments/report/tradeoff_formats.h"
#include "tests/support/store_fixture.h"

namespace misbench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Plan with_snapshots(Plan plan) {
    for (Cell& cell : plan.cells) {
        if (cell.role == Role::Test) cell.task.snapshots = SnapshotLadder{};
    }
    return plan;
}

// The cells of a second budget beside those of the first.
Plan with_budget(Plan plan, const Plan& other) {
    plan.budgets.push_back(other.budgets.front());
    for (const Cell& cell : other.cells) {
        if (cell.role == Role::Test) plan.cells.push_back(cell);
    }
    return plan;
}

class TradeoffTest : public testing::Test {
 protected:
    TradeoffTest() : store_(temporary_.path() / "store", Store::Access::ReadWrite) {}

    void fill(const Plan& plan) {
        store_.put_experiment(plan);
        for (const Cell& cell : plan.cells) {
            commit_made_up_run(store_, cell.task, [&cell](Record& record) {
                const auto* budget = std::get_if<SampleBudget>(&cell.task.budget);
                if (budget == nullptr) return;
                const double n = double(budget->samples);
                record.statistics.passes = budget->samples;
                record.statistics.cpu_seconds = cell.method == "clever" ? 0.2 * n : 0.125 * n;
                record.statistics.wall_seconds = 0.0625 * n;
            });
        }
        store_.measure(plan);
    }
    std::vector<Curve> curves(const Plan& plan) { return convergence(store_, plan); }

 private:
    TemporaryFolder temporary_;

 protected:
    Store store_;
};

std::vector<std::pair<double, bool>> passes_of(const Curve& curve) {
    std::vector<std::pair<double, bool>> points;
    for (const CurvePoint& point : curve.points) {
        points.emplace_back(point.passes, point.is_snapshot);
    }
    return points;
}

TEST_F(TradeoffTest, SnapshotsArePointsOfTheCurve) {
    const Plan plan = with_snapshots(made_up_plan("first", 4));
    fill(plan);
    const auto found = curves(plan);
    ASSERT_EQ(found.size(), 2U);
    using P = std::pair<double, bool>;
    EXPECT_THAT(passes_of(found[0]),
                ElementsAre(P(1, true), P(2, true), P(4, true), P(8, true), P(16, false)));
    const CurvePoint& second = found[0].points[1];
    EXPECT_EQ(second.cpu_seconds, 0.25);
    EXPECT_THAT(second.seeds, ElementsAre(1, 2, 3, 4));
    const auto all = store_.snapshot_measurements(plan, "relmse.eps0.01");
    const std::string run = task_id(plan.cells[4].task);  // "plain", seed 2
    const auto same = std::ranges::find_if(
        all, [&](const SnapshotMeasurement& m) { return m.run == run && m.samples == 2; });
    EXPECT_EQ(second.values[1], same->value);
    EXPECT_EQ(second.mean, estimate_mean(second.values));
}

TEST_F(TradeoffTest, SnapshotsThatAShorterBudgetHasAlreadyAreNoFurtherPoints) {
    const Plan plan = with_budget(with_snapshots(made_up_plan("first", 3, SampleBudget{4})),
                                  with_snapshots(made_up_plan("first", 3, SampleBudget{16})));
    fill(plan);
    using P = std::pair<double, bool>;
    EXPECT_THAT(passes_of(curves(plan)[0]),
                ElementsAre(P(1, true), P(2, true), P(4, false), P(8, true), P(16, false)));
}

TEST_F(TradeoffTest, SnapshotsThatNotAllSeedsHaveAreLeftOut) {
    Plan plan = with_snapshots(made_up_plan("first", 3));
    // A render of a time budget that came less far.
    for (Cell& cell : plan.cells) {
        if (cell.method == "plain" && cell.seed == 3) cell.task.snapshots->first = 2;
    }
    fill(plan);
    using P = std::pair<double, bool>;
    EXPECT_THAT(passes_of(curves(plan)[0]),
                ElementsAre(P(2, true), P(4, true), P(8, true), P(16, false)));
}

TEST_F(TradeoffTest, SaysSlopeFloorTargetCrossoverAndFrontOfAScene) {
    const Plan plan = with_snapshots(made_up_plan("first", 6));
    fill(plan);
    const Tradeoff found = tradeoff(store_, plan, Effort::Passes, {});
    EXPECT_EQ(found.baseline, "plain");
    ASSERT_EQ(found.scenes.size(), 1U);
    ASSERT_EQ(found.scenes[0].methods.size(), 2U);
    const TradeoffMethod& plain = found.scenes[0].methods[0];
    const TradeoffMethod& clever = found.scenes[0].methods[1];
    // The variance is that of independent samples, and a quarter of it for "clever".
    EXPECT_NEAR(plain.slope->value, 1, 0.15);
    EXPECT_NEAR(clever.slope->value, 1, 0.15);
    EXPECT_FALSE(has_floor(*plain.floor));
    EXPECT_EQ(found.scenes[0].target, plain.points.back().point.mean->value);
    EXPECT_NEAR(plain.to_target->effort->value, 16, 1e-9);
    EXPECT_NEAR(clever.to_target->effort->value, 4, 1);
    EXPECT_EQ(clever.to_target->where, EffortTo::Where::Within);
    EXPECT_FALSE(plain.against_baseline);
    EXPECT_EQ(clever.against_baseline->n_crossings, 0);
    EXPECT_TRUE(clever.against_baseline->is_first_ahead);
    for (const TradeoffPoint& p : clever.points) EXPECT_TRUE(p.is_on_front);
    for (const TradeoffPoint& p : plain.points) EXPECT_FALSE(p.is_on_front);
    EXPECT_TRUE(found.overall.empty()) << "of a single scene there is nothing to say over all";

    const Tradeoff by_cost = tradeoff(store_, plan, Effort::Cpu, {.against = "clever"});
    EXPECT_NEAR(by_cost.scenes[0].methods[1].points.back().effort, 3.2, 1e-9);
    EXPECT_TRUE(by_cost.scenes[0].methods[0].against_baseline.has_value());
    const Tradeoff aimed = tradeoff(store_, plan, Effort::Passes, {.target = 1e-9});
    EXPECT_NE(aimed.scenes[0].methods[0].to_target->where, EffortTo::Where::Within);
}

// Two scenes, of which the second is the first under another name.
Plan two_scenes(Plan plan) {
    plan.scenes.push_back({.name = "Copy", .exposure = 0});
    const std::vector<Cell> cells = plan.cells;
    for (Cell cell : cells) {
        cell.scene = "Copy";
        plan.cells.push_back(cell);
    }
    return plan;
}

TEST_F(TradeoffTest, OverAllScenesIsTheGeometricMeanOfTheRatiosToTheBaseline) {
    const Plan plan = two_scenes(made_up_plan("first", 4));
    fill(plan);
    const Tradeoff found = tradeoff(store_, plan, Effort::Cpu, {});
    ASSERT_EQ(found.overall.size(), 2U);
    const OverallTradeoff& clever = found.overall[1];
    EXPECT_EQ(clever.n_scenes, 2);
    EXPECT_NEAR(clever.cost, 1.6, 1e-9);
    const Comparison comparison = compare(store_, plan);
    EXPECT_NEAR(clever.error.value,
                comparison.find("Copy", "clever", SampleBudget{16})->ratio->value, 1e-12);
    EXPECT_TRUE(clever.is_on_front && found.overall[0].is_on_front);
    EXPECT_EQ(tradeoff(store_, plan, Effort::Cpu, {.scene = "Copy"}).scenes.size(), 1U);
}

// "plain" and "clever" are one method with two values of a parameter.
Plan with_parameter(Plan plan) {
    for (Cell& cell : plan.cells) {
        if (cell.role != Role::Test) continue;
        cell.task.parameters["radius"] = cell.method == "clever" ? 0.5 : 2.0;
        cell.task.seed += cell.method == "clever" ? 500 : 0;
        cell.task.method = "plain";
    }
    return plan;
}

TEST_F(TradeoffTest, ByAParameterSaysWhatAPercentOfErrorCosts) {
    Plan plan = with_parameter(made_up_plan("first", 4));
    fill(plan);
    const ParameterTradeoff found =
        parameter_tradeoff(store_, plan, "radius", {.metric = "relmse"});
    EXPECT_EQ(found.metric, "relmse.eps0.01");
    ASSERT_EQ(found.ladders.size(), 1U);
    const auto& steps = found.ladders[0].steps;
    ASSERT_EQ(steps.size(), 2U);
    EXPECT_EQ(steps[0].value, "0.5");
    EXPECT_EQ(steps[0].method, "clever");
    EXPECT_EQ(steps[1].method, "plain");
    EXPECT_FALSE(steps[0].error_ratio);
    EXPECT_NEAR(steps[1].cost_ratio, 0.125 / 0.2, 1e-9);
    EXPECT_NEAR(steps[1].error_ratio->value, steps[1].error.value / steps[0].error.value, 1e-12);
    EXPECT_EQ(steps[0].seconds_per_pass, 0.2);
    EXPECT_FALSE(steps[1].price && !(steps[1].error_ratio->interval->high < 1));
    EXPECT_THAT(ladders_to_csv(found), HasSubstr("first,Box,16 spp,,radius,0.5,clever,relmse"));
    EXPECT_THAT(ladders_to_text(found), HasSubstr("×0.625"));
}

TEST_F(TradeoffTest, RefusesWhatThePlanDoesNotHave) {
    const Plan plan = with_parameter(made_up_plan("first", 3));
    fill(plan);
    const auto refusal = [&](const TradeoffQuestion& question) {
        return message_of(Errc::InvalidArgument,
                          [&] { tradeoff(store_, plan, Effort::Cpu, question); });
    };
    EXPECT_THAT(refusal({.metric = "flip"}), HasSubstr("known: relmse.eps0.01 mse"));
    EXPECT_THAT(refusal({.scene = "Bxo"}), HasSubstr("no scene 'Bxo'; known: Box"));
    EXPECT_THAT(refusal({.against = "pt"}), HasSubstr("no method 'pt'; known: plain clever"));
    EXPECT_THAT(message_of(Errc::InvalidArgument,
                           [&] { parameter_tradeoff(store_, plan, "max_depth", {}); }),
                HasSubstr("differ in 'max_depth' alone; known: cost passes wall radius"));
}

TEST_F(TradeoffTest, ACellIsNoisyWhereTheReferenceHasAShareOfItsError) {
    Plan plan = made_up_plan("first", 3);
    for (Cell& cell : plan.cells) {
        if (cell.role != Role::Test) cell.budget = cell.task.budget = SampleBudget{128};
    }
    fill(plan);
    // Variances 1/16 and 1/64 against 1/256 of the reference: shares about 6 % and 20 %.
    const auto cells = cell_reference_shares(store_, plan);
    ASSERT_EQ(cells.size(), 2U);
    EXPECT_EQ(cells[1].method, "clever");
    EXPECT_TRUE(cells[1].is_noisy());
    EXPECT_EQ(cells[1].share, compare(store_, plan).cells[1].reference_share);

    const Plan better = with_better_references(plan, {"Box"}, 8);
    EXPECT_EQ(better.cells[0].budget, Budget(SampleBudget{1024}));
    EXPECT_EQ(better.cells[1].task.budget, Budget(SampleBudget{1024}));
    EXPECT_EQ(better.cells[0].seed, plan.cells[0].seed);
    EXPECT_EQ(better.cells[2], plan.cells[2]);
    EXPECT_EQ(with_better_references(plan, {}, 8), plan);
    fill(better);
    EXPECT_FALSE(cell_reference_shares(store_, better)[0].is_noisy());
    EXPECT_LT(cell_reference_shares(store_, better)[1].share, cells[1].share / 3);
}

TEST_F(TradeoffTest, IsPrintedWithItsMarksAndInFullPrecision) {
    const Plan plan = with_snapshots(made_up_plan("first", 4));
    fill(plan);
    const Tradeoff found = tradeoff(store_, plan, Effort::Passes, {});
    const std::string text = tradeoff_to_text(found);
    EXPECT_THAT(text, HasSubstr("ahead throughout"));
    EXPECT_THAT(text, HasSubstr("8 °"));
    EXPECT_THAT(text, HasSubstr("none found, at most"));
    EXPECT_THAT(text, HasSubstr("spp to an error: that of 'plain' at its last effort"));
    EXPECT_THAT(tradeoff_to_text(tradeoff(store_, plan, Effort::Passes, {.target = 0.5})),
                HasSubstr("spp to an error: the one asked for"));
    EXPECT_THAT(tradeoff_to_markdown(found), HasSubstr("| clever |"));
    const auto json = nlohmann::json::parse(tradeoff_to_json(found));
    ASSERT_EQ(json["points"].size(), 10U);
    EXPECT_EQ(json["points"][0]["error"], found.scenes[0].methods[0].points[0].point.mean->value);
    EXPECT_EQ(json["points"][9]["ahead_at_last"], true);
    const std::string csv = tradeoff_to_csv(found);
    EXPECT_EQ(std::ranges::count(csv, '\n'), 11);
    EXPECT_THAT(csv,
                HasSubstr("first,Box,clever,relmse.eps0.01,plain,spp,8.0,8.0,1.0,0.5,true,4,"));
}

}  // namespace
}  // namespace misbench
