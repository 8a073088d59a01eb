#include "experiments/analysis/comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "experiments/analysis/scene_means.h"
#include "experiments/statistics/bootstrap.h"
#include "renderer/base/error.h"
#include "results/schema.h"
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

    // Rare samples, as it were.
    void multiply_errors(const Cell& cell, double factor) {
        open_database(store_.folder() / "results.sqlite", Database::Access::ReadWrite)
            ->prepare("UPDATE measurements SET value = ?1 * value WHERE run = ?2")
            .bind(factor, task_id(cell.task))
            .run();
    }

    const Cell& planned(const Plan& plan, const std::string& method, std::int64_t seed,
                        const Budget& budget) const {
        return *std::ranges::find_if(plan.cells, [&](const Cell& cell) {
            return cell.role == Role::Test && cell.method == method && cell.seed == seed &&
                   cell.budget == budget;
        });
    }

    // With a second budget.
    Plan two_budgets() {
        Plan plan = plan_;
        plan.budgets.push_back(longer_);
        for (const Cell& cell : made_up_plan("first", 5, longer_).cells) {
            if (cell.role == Role::Test) plan.cells.push_back(cell);
        }
        store_.put_experiment(plan);
        commit_all(store_, plan);
        store_.measure(plan);
        return plan;
    }

    // Five scenes, as far as ratios go.
    Comparison five_scenes() {
        commit_all(store_, plan_);
        store_.measure(plan_);
        Comparison comparison = compare(store_, plan_);
        const std::vector<ComparedCell> cells = comparison.cells;
        for (int i = 1; i < 5; ++i) {
            comparison.scenes.push_back("Box/" + std::to_string(i));
            for (ComparedCell cell : cells) {
                cell.scene = comparison.scenes.back();
                if (cell.ratio_log) cell.ratio_log->value += 0.1 * i;
                comparison.cells.push_back(cell);
            }
        }
        return comparison;
    }

    const Plan plan_ = made_up_plan("first", 5);
    const Budget budget_ = SampleBudget{16};
    const Budget longer_ = SampleBudget{64};

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
    EXPECT_EQ(clever.tail_verdict, TailVerdict::Calm);
    EXPECT_EQ(clever.tail, max_over_median(clever.values));
    EXPECT_EQ(clever.reference_share, mean_reference_share(store_.cell_seeds("first", {})[1]));
    EXPECT_GT(clever.reference_share, 0.01);
    EXPECT_FALSE(compare(store_, plan_, "passes").cells[1].reference_share);
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
                     "seconds_per_pass passes cpu_seconds wall_seconds rays, and METRIC*cpu, "
                     "1/(METRIC*cpu) and tail(METRIC)");
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

// --- tails ---------------------------------------------------------------------------------------

TEST_F(ComparisonTest, WhereRareSeedsOfEitherCarryTheErrorThereIsNoVerdict) {
    commit_all(store_, plan_);
    store_.measure(plan_);
    multiply_errors(planned(plan_, "plain", 3, budget_), 50);
    for (const char* quantity : {"", "mse*cpu", "1/(mse*cpu)"}) {
        const Comparison comparison = compare(store_, plan_, quantity);
        const ComparedCell& plain = comparison.cells[0];
        const ComparedCell& clever = comparison.cells[1];
        EXPECT_EQ(plain.tail_verdict, TailVerdict::Dishonest);
        EXPECT_FALSE(plain.has_heavy_tail());
        EXPECT_FALSE(plain.mean->interval);
        EXPECT_EQ(plain.mean->why_none, NoInterval::HeavyTail);
        EXPECT_TRUE(clever.mean->interval) << "its own seeds are calm";
        ASSERT_TRUE(clever.ratio);
        EXPECT_FALSE(clever.ratio->interval);
        EXPECT_EQ(clever.ratio->why_none, NoInterval::HeavyTail);
        EXPECT_FALSE(clever.p || clever.adjusted_p || clever.differs());
    }
    store_comparisons(store_, plan_);
    EXPECT_EQ(open_database(store_.folder() / "results.sqlite", Database::Access::ReadOnly)
                  ->integer("SELECT count(*) FROM comparisons WHERE low IS NULL AND p IS NULL"),
              2);
}

TEST_F(ComparisonTest, ATailThatWasMetTwiceIsMarkedAndKeepsItsInterval) {
    commit_all(store_, plan_);
    store_.measure(plan_);
    for (const std::int64_t seed : {2, 3}) {
        multiply_errors(planned(plan_, "clever", seed, budget_), 50);
    }
    const Comparison comparison = compare(store_, plan_);
    const ComparedCell& clever = comparison.cells[1];
    EXPECT_TRUE(clever.has_heavy_tail());
    EXPECT_TRUE(clever.mean->interval && clever.ratio->interval && clever.p);
}

TEST_F(ComparisonTest, ATailIsKnownFromOtherBudgetsWhateverIsAskedFor) {
    const Plan plan = two_budgets();
    EXPECT_TRUE(compare(store_, plan).cells[1].ratio->interval);
    multiply_errors(planned(plan, "clever", 3, longer_), 50);
    Question question;
    for (const char* where : {"", "budget=16spp"}) {
        for (const auto& budget : {std::optional<Budget>(), std::optional(budget_)}) {
            question.where = where;
            question.budget = budget;
            const Comparison comparison = compare(store_, plan, question);
            const ComparedCell* plain = comparison.find("Box", "plain", budget_);
            const ComparedCell* clever = comparison.find("Box", "clever", budget_);
            EXPECT_LT(*clever->tail, 2) << "its own seeds show nothing";
            EXPECT_EQ(clever->mean->why_none, NoInterval::HeavyTail);
            EXPECT_EQ(clever->ratio->why_none, NoInterval::HeavyTail);
            EXPECT_TRUE(plain->mean->interval);
        }
    }
}

TEST_F(ComparisonTest, ATailIsAskedForAsAQuantityOfACell) {
    commit_all(store_, plan_);
    store_.measure(plan_);
    const Comparison errors = compare(store_, plan_, "mse");
    const Comparison tails = compare(store_, plan_, "tail(mse)");
    EXPECT_EQ(tails.metric, "tail(mse)");
    EXPECT_EQ(tails.baseline, kToNone);
    for (const std::size_t i : {0U, 1U}) {
        EXPECT_EQ(tails.cells[i].mean->value, errors.cells[i].tail);
        EXPECT_EQ(tails.cells[i].mean->why_none, NoInterval::NoEstimate);
        EXPECT_FALSE(tails.cells[i].ratio);
    }
    for (const char* nonsense : {"tail(passes)", "tail(mean)", "tail(mse", "tail()"}) {
        EXPECT_THROW(compare(store_, plan_, nonsense), ParameterError) << nonsense;
    }
}

// --- over scenes ---------------------------------------------------------------------------------

TEST_F(ComparisonTest, MeansOverScenesAreOfTheseScenesAndOfScenesLikeThem) {
    Comparison comparison = five_scenes();
    std::vector<double> values;
    std::vector<LogRatio> ratios;
    for (const ComparedCell& cell : comparison.cells) {
        if (!cell.ratio_log) continue;
        ratios.push_back(*cell.ratio_log);
        values.push_back(cell.ratio_log->value);
    }
    add_means_over_scenes(comparison, false);
    ASSERT_EQ(comparison.cells.size(), 12U);
    const ComparedCell& these = comparison.cells[10];
    const ComparedCell& such = comparison.cells[11];
    EXPECT_EQ(these.scene, "geometric mean of these 5 scenes");
    EXPECT_EQ(such.scene, "geometric mean of scenes like these 5");
    EXPECT_TRUE(these.is_mean_of_scenes && such.is_mean_of_scenes);
    EXPECT_EQ(these.ratio, to_ratio(mean_log_ratio(ratios)));
    EXPECT_EQ(these.p, p_value(mean_log_ratio(ratios)));
    EXPECT_NEAR(these.ratio->value, std::exp(values[0] + 0.2), 1e-12);
    EXPECT_EQ(such.ratio, geometric_mean_over_scenes(values));
    EXPECT_TRUE(such.ratio->interval);
    EXPECT_FALSE(such.p);
    adjust_p_values({&comparison, 1});
    EXPECT_TRUE(comparison.cells[10].adjusted_p);
    EXPECT_FALSE(comparison.cells[11].adjusted_p || comparison.cells[11].differs());
}

TEST_F(ComparisonTest, MeansOverScenesNeedEveryRatioAndHonestOnes) {
    const Comparison whole = five_scenes();
    Comparison dishonest = whole;
    dishonest.cells[3].ratio_log->why_none = NoInterval::HeavyTail;
    add_means_over_scenes(dishonest, false);
    for (const std::size_t i : {10U, 11U}) {
        EXPECT_FALSE(dishonest.cells[i].ratio->interval || dishonest.cells[i].p);
        EXPECT_EQ(dishonest.cells[i].ratio->why_none, NoInterval::HeavyTail);
    }
    Comparison lacking = whole;
    lacking.cells[3].ratio_log.reset();
    add_means_over_scenes(lacking, false);
    EXPECT_EQ(lacking.cells.size(), 10U);
}

TEST_F(ComparisonTest, FewScenesSayNothingOfOthers) {
    Comparison comparison = five_scenes();
    comparison.scenes.back() = "Hall";
    for (ComparedCell& cell : comparison.cells) {
        if (cell.scene == "Box/4") cell.scene = "Hall";
    }
    add_means_over_scenes(comparison, true);
    EXPECT_EQ(comparison.scenes[5], "geometric mean of these 4 scenes of Box");
    EXPECT_EQ(comparison.scenes[8], "geometric mean of scenes like this of Hall");
    EXPECT_TRUE(comparison.cells[10].ratio->interval);
    EXPECT_EQ(comparison.cells[11].ratio->why_none, NoInterval::TooFewToResample);
}

}  // namespace
}  // namespace misbench
