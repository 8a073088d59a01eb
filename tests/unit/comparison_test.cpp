#include "experiments/analysis/comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "renderer/base/error.h"
#include "tests/support/made_up_store.h"

namespace misbench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class ComparisonTest : public testing::Test {
 protected:
    ComparisonTest() : store_(temporary_.path() / "store", Store::Access::ReadWrite) {
        store_.put_experiment(plan_);
    }

    void commit(const Cell& cell, const RecordChange& change = {}) {
        commit_made_up_run(store_, cell.task, change);
    }

    const Plan plan_ = made_up_plan("first", 5);
    const Budget budget_ = SampleBudget{16};

 private:
    TemporaryFolder temporary_;

 protected:
    Store store_;
};

TEST_F(ComparisonTest, SaysWhichMethodIsBetterAndHowSureThatIs) {
    commit_all(store_, plan_);
    store_.measure(plan_);
    const Comparison comparison = compare(store_, plan_);
    EXPECT_EQ(comparison.metric, "relmse.eps0.01");
    EXPECT_EQ(comparison.better, Direction::Less);
    EXPECT_THAT(comparison.scenes, ElementsAre("Box"));
    ASSERT_EQ(comparison.cells.size(), 2U);
    const ComparedCell& plain = comparison.cells[0];
    const ComparedCell& clever = comparison.cells[1];
    EXPECT_EQ(comparison.find("Box", "clever", budget_), &clever);
    EXPECT_EQ(comparison.find("Box", "clever", SampleBudget{8}), nullptr);
    EXPECT_TRUE(plain.is_baseline && plain.is_complete() && !plain.ratio);
    EXPECT_EQ(plain.n_measured, 5);
    EXPECT_EQ(plain.mean_passes, 16);
    EXPECT_DOUBLE_EQ(plain.mean->value,
                     std::accumulate(plain.values.begin(), plain.values.end(), 0.0) / 5);
    // Half the noise is a quarter of the error.
    ASSERT_TRUE(clever.ratio);
    EXPECT_NEAR(clever.ratio->value, 0.25, 0.1);
    EXPECT_DOUBLE_EQ(clever.ratio->value, clever.mean->value / plain.mean->value);
    EXPECT_TRUE(clever.ratio_excludes_one());
    EXPECT_FALSE(clever.has_heavy_tail());
    EXPECT_TRUE(clever.ratio_is_paired);
    EXPECT_THAT(clever.seeds, ElementsAre(1, 2, 3, 4, 5));
    EXPECT_EQ(clever.ratio, estimate_paired_ratio(clever.values, plain.values));
}

TEST_F(ComparisonTest, ComparesSeedBySeedOnlyWhereBothHaveTheSame) {
    for (const Cell& cell : plan_.cells) {
        if (cell.method == "clever" && cell.seed == 2) continue;
        if (cell.method == "plain" && cell.seed == 4) continue;
        commit(cell);
    }
    store_.measure(plan_);
    const Comparison comparison = compare(store_, plan_);
    const ComparedCell& plain = comparison.cells[0];
    const ComparedCell& clever = comparison.cells[1];
    EXPECT_THAT(clever.seeds, ElementsAre(1, 3, 4, 5));
    EXPECT_EQ(plain.values.size(), clever.values.size());
    EXPECT_FALSE(clever.ratio_is_paired);
    EXPECT_EQ(clever.ratio, estimate_ratio(clever.values, plain.values));
}

TEST_F(ComparisonTest, TimesOfAPassAreComparedLikeAMetric) {
    for (const Cell& cell : plan_.cells) {
        commit(cell, [&cell](Record& record) {
            record.statistics.passes = 4 * cell.seed;
            record.statistics.cpu_seconds =
                static_cast<double>(cell.seed) * (cell.method == "plain" ? 2 : 3);
        });
    }
    const Comparison comparison = compare(store_, plan_, kSecondsPerPass);
    EXPECT_THAT(comparison.cells[0].values, ElementsAre(0.5, 0.5, 0.5, 0.5, 0.5));
    EXPECT_THAT(comparison.cells[1].values, ElementsAre(0.75, 0.75, 0.75, 0.75, 0.75));
    EXPECT_DOUBLE_EQ(comparison.cells[1].ratio->value, 1.5);
    EXPECT_EQ(comparison.cells[1].ratio->why_none, NoInterval::NoSpread);
}

TEST_F(ComparisonTest, CountsWhatBecameOfEverySeed) {
    // Of the five seeds of "clever": measured, invalid, failed, unfinished, unfinished.
    for (const Cell& cell : plan_.cells) {
        if (cell.method == "clever" && cell.seed >= 3) continue;
        const bool valid = cell.method != "clever" || cell.seed != 2;
        commit(cell, [valid](Record& record) { record.valid = valid; });
    }
    for (TaskRow row : store_.tasks()) {
        if (row.task.method != "clever" || row.task.seed != 3) continue;
        row.state = TaskState::Failed;
        store_.save_task_state(row);
    }
    const Comparison before = compare(store_, plan_);
    EXPECT_EQ(before.cells[1].n_unreferenced, 1);
    store_.measure(plan_);
    const Comparison comparison = compare(store_, plan_);
    const ComparedCell& clever = comparison.cells[1];
    EXPECT_EQ(clever.n_planned, 5);
    EXPECT_EQ(clever.n_measured, 1);
    EXPECT_EQ(clever.n_invalid, 1);
    EXPECT_EQ(clever.n_failed, 1);
    EXPECT_EQ(clever.n_unfinished, 2);
    EXPECT_EQ(clever.n_unreferenced, 0);
    EXPECT_FALSE(clever.is_complete());
    ASSERT_TRUE(clever.ratio);
    EXPECT_EQ(clever.ratio->why_none, NoInterval::TooFewValues);
    EXPECT_FALSE(clever.ratio_excludes_one());
    EXPECT_EQ(clever.tail, std::nullopt);
}

TEST_F(ComparisonTest, HasNoNumbersBeforeTheFirstRun) {
    const Comparison comparison = compare(store_, plan_);
    for (const ComparedCell& cell : comparison.cells) {
        EXPECT_EQ(cell.n_unfinished, 5);
        EXPECT_FALSE(cell.mean || cell.ratio || cell.tail);
    }
}

TEST_F(ComparisonTest, LeavesOutExcludedCellsAndHasNoRatioWithoutTheirBaseline) {
    Plan plan = plan_;
    std::erase_if(plan.cells, [](const Cell& cell) { return cell.method == "plain"; });
    store_.put_experiment(plan);
    commit_all(store_, plan);
    store_.measure(plan);
    const Comparison comparison = compare(store_, plan);
    ASSERT_EQ(comparison.cells.size(), 1U);
    EXPECT_TRUE(comparison.cells[0].mean && !comparison.cells[0].ratio);
}

TEST_F(ComparisonTest, MarksFewPassesUnderATimeBudgetOnly) {
    const Budget time = TimeBudget{0.5, BudgetClock::Cpu};
    for (const Budget& budget : {time, budget_}) {
        const Plan plan = made_up_plan("second", 3, budget);
        store_.put_experiment(plan);
        for (const Cell& cell : plan.cells) {
            const bool few = cell.method == "clever" && cell.seed == 2;
            commit(cell, [few](Record& record) {
                record.statistics.passes = few ? kFewPasses - 1 : kFewPasses;
            });
        }
        const Comparison comparison = compare(store_, plan);
        EXPECT_FALSE(comparison.cells[0].few_passes);
        EXPECT_EQ(comparison.cells[1].few_passes, budget == time);
    }
}

TEST_F(ComparisonTest, TakesTheMetricAndTheBudgetAskedFor) {
    commit_all(store_, plan_);
    store_.measure(plan_);
    EXPECT_EQ(compare(store_, plan_, "mse", budget_).metric, "mse");
    EXPECT_NE(compare(store_, plan_, "mse").cells[0].values,
              compare(store_, plan_).cells[0].values);
    try {
        compare(store_, plan_, "mean");
        ADD_FAILURE() << "compared";
    } catch (const ParameterError& e) {
        EXPECT_STREQ(e.what(),
                     "experiment 'first' does not measure 'mean'; known: relmse.eps0.01 mse "
                     "seconds_per_pass passes cpu_seconds wall_seconds rays, and METRIC*cpu and "
                     "1/(METRIC*cpu)");
    }
    try {
        compare(store_, plan_, "mse", SampleBudget{17});
        ADD_FAILURE() << "compared";
    } catch (const ParameterError& e) {
        EXPECT_STREQ(e.what(), "experiment 'first' has no budget '17 spp'; known: '16 spp'");
    }
}

TEST_F(ComparisonTest, AdjustsEveryRatioForAllOfThem) {
    commit_all(store_, plan_);
    store_.measure(plan_);
    std::vector<Comparison> both{compare(store_, plan_), compare(store_, plan_, kSecondsPerPass)};
    const ComparedCell& error = both[0].cells[1];
    const ComparedCell& time = both[1].cells[1];
    ASSERT_TRUE(error.p && time.p);
    EXPECT_EQ(error.p, p_value(*error.ratio_log));
    EXPECT_EQ(error.adjusted_p, error.p);  // the only one
    EXPECT_EQ(time.p, 1);                  // the same time, seed by seed
    EXPECT_TRUE(error.differs());
    adjust_p_values(both);
    EXPECT_DOUBLE_EQ(*both[0].cells[1].adjusted_p, 2 * *error.p);
    EXPECT_FALSE(both[0].cells[0].adjusted_p);
}

TEST_F(ComparisonTest, AsksForSeedsBaselinesAndCosts) {
    for (const Cell& cell : plan_.cells) {
        commit(cell, [&cell](Record& record) {
            record.statistics.cpu_seconds = static_cast<double>(cell.seed);
        });
    }
    store_.measure(plan_);
    const auto ask = [this](std::string Question::*part, const std::string& text) {
        Question question;
        question.*part = text;
        return compare(store_, plan_, question);
    };
    const Comparison all = compare(store_, plan_);
    const Comparison some = ask(&Question::where, "method=clever and seed<=3");
    ASSERT_EQ(some.cells.size(), 1U);
    EXPECT_THAT(some.methods, ElementsAre("clever"));
    EXPECT_THAT(some.cells[0].seeds, ElementsAre(1, 2, 3));
    EXPECT_EQ(some.cells[0].n_planned, 3);
    EXPECT_TRUE(ask(&Question::where, "max_depth>3").cells.empty());

    const Comparison to_clever = ask(&Question::ratio_to, "clever");
    EXPECT_TRUE(to_clever.cells[1].is_baseline);
    EXPECT_NEAR(to_clever.cells[0].ratio->value, 1 / all.cells[1].ratio->value, 1e-12);
    const Comparison to_best = ask(&Question::ratio_to, kToBest);
    EXPECT_TRUE(to_best.cells[1].is_baseline);
    EXPECT_FALSE(to_best.cells[0].adjusted_p);
    EXPECT_FALSE(ask(&Question::ratio_to, kToNone).cells[1].ratio);
    EXPECT_THROW(ask(&Question::ratio_to, "cleverer"), ParameterError);

    const Comparison cost = ask(&Question::quantity, "mse*cpu");
    const Comparison error = ask(&Question::quantity, "mse");
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_DOUBLE_EQ(cost.cells[0].values[i],
                         error.cells[0].values[i] * static_cast<double>(i + 1));
    }
    const Comparison efficiency = ask(&Question::quantity, "1/(mse*cpu)");
    EXPECT_EQ(efficiency.better, Direction::More);
    EXPECT_DOUBLE_EQ(efficiency.cells[1].mean->value, 1 / cost.cells[1].mean->value);
    EXPECT_NEAR(efficiency.cells[1].ratio->value, 1 / cost.cells[1].ratio->value, 1e-12);
    EXPECT_NEAR(efficiency.cells[1].ratio->interval->low, 1 / cost.cells[1].ratio->interval->high,
                1e-12);
}

TEST_F(ComparisonTest, MeansOverScenesAreOfRatiosAndNeedThemAll) {
    commit_all(store_, plan_);
    store_.measure(plan_);
    Comparison comparison = compare(store_, plan_);
    const Estimate ratio = *comparison.cells[1].ratio;
    for (int i = 0; i < 2; ++i) {
        ComparedCell other = comparison.cells[static_cast<std::size_t>(i)];
        other.scene = "Box/Two";
        if (other.ratio_log) other.ratio_log->value += 1;
        comparison.cells.push_back(other);
    }
    comparison.scenes.emplace_back("Box/Two");
    add_means_over_scenes(comparison, false);
    const ComparedCell& mean = comparison.cells.back();
    EXPECT_TRUE(mean.is_mean_of_scenes);
    EXPECT_EQ(mean.scene, "geometric mean of 2 scenes");
    EXPECT_NEAR(mean.ratio->value, ratio.value * std::exp(0.5), 1e-12);

    Comparison grouped = comparison;
    grouped.scenes.pop_back();
    grouped.cells.pop_back();
    grouped.cells.back().ratio_log.reset();
    Comparison lacking = grouped;
    add_means_over_scenes(lacking, true);
    EXPECT_FALSE(lacking.cells.back().is_mean_of_scenes);
}

}  // namespace
}  // namespace misbench
