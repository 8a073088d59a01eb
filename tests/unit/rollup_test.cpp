// Rollups are copies: whatever happens to a store, and whoever does it, what tables read is what
// the rows say.
#include "results/rollup.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "results/schema.h"
#include "tests/support/made_up_rows.h"
#include "tests/support/made_up_store.h"

namespace misbench {
namespace {

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

void expect_same(const CellSeeds& a, const CellSeeds& b) {
    EXPECT_EQ(a.scene, b.scene);
    EXPECT_EQ(a.method, b.method);
    EXPECT_EQ(a.budget, b.budget);
    EXPECT_EQ(a.parameters, b.parameters);
    EXPECT_EQ(a.states, b.states);
    EXPECT_EQ(a.seeds, b.seeds);
    EXPECT_EQ(a.passes, b.passes);
    EXPECT_EQ(a.wall_seconds, b.wall_seconds);
    EXPECT_EQ(a.cpu_seconds, b.cpu_seconds);
    EXPECT_EQ(a.rays, b.rays);
    EXPECT_TRUE(same_bits(a.reference_shares, b.reference_shares));
    ASSERT_EQ(a.values.size(), b.values.size());
    for (const auto& [metric, values] : a.values) {
        EXPECT_TRUE(same_bits(values, b.values.at(metric))) << metric;
    }
}

const std::vector<std::string> kMetrics{"relmse.eps0.01", "mse"};

class RollupTest : public testing::Test {
 protected:
    RollupTest()
        : path_(temporary_.path() / "store"),
          store_(std::make_unique<Store>(path_, Store::Access::ReadWrite)) {}

    // Whatever is shown is what the rows say. Returns whether it came from a rollup.
    bool check(const std::string& experiment) {
        const auto database = open_database(path_ / "results.sqlite", Database::Access::ReadOnly);
        const auto shown = select_cells(*database, experiment, kMetrics);
        auto rows = recompute_cells(*database, experiment);
        for (CellSeeds& cell : rows) {
            std::erase_if(cell.values, [](const auto& entry) {
                return std::ranges::find(kMetrics, entry.first) == kMetrics.end();
            });
        }
        EXPECT_EQ(shown.size(), rows.size());
        for (std::size_t i = 0; i < std::min(shown.size(), rows.size()); ++i) {
            expect_same(shown[i], rows[i]);
        }
        int n_runs = 0;
        for (const Origin& origin : select_origins(*database, experiment)) n_runs += origin.n_runs;
        int n_states = 0;
        for (const CellSeeds& cell : rows) {
            n_states += static_cast<int>(std::ranges::count_if(
                cell.states, [](char state) { return state == 'v' || state == 'i'; }));
        }
        EXPECT_EQ(n_runs, n_states);
        return database->integer("SELECT count(*) FROM rollup_cells WHERE experiment = '" +
                                 experiment + "'") > 0;
    }

    TemporaryFolder temporary_;
    std::filesystem::path path_;
    std::unique_ptr<Store> store_;
};

TEST_F(RollupTest, SaysWhatTheRowsSayAfterAnyHistory) {
    std::mt19937 random(7);
    const auto pick = [&random](std::size_t n) {
        return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
    };
    std::vector<Plan> plans{made_up_plan("first", 4), made_up_plan("second", 6)};
    for (const Plan& plan : plans) store_->put_experiment(plan);
    int n_from_rollups = 0;
    for (int step = 0; step < 150; ++step) {
        const Plan& plan = plans[pick(plans.size())];
        const Cell& cell = plan.cells[pick(plan.cells.size())];
        switch (pick(5)) {
            case 0:
            case 1:
                commit_made_up_run(*store_, cell.task, [&](Record& record) {
                    record.valid = pick(6) != 0 || cell.role != Role::Test;
                    record.provenance.host = pick(2) == 0 ? "here" : "there";
                });
                break;
            case 2:
                if (auto row = store_->task(task_id(cell.task)); row && pick(2) == 0) {
                    row->state = store_->has_run(row->id) ? TaskState::Done
                                 : pick(2) == 0           ? TaskState::Failed
                                                          : TaskState::Leased;
                    store_->save_task_state(*row);
                }
                break;
            case 3:
                store_->measure(plan);
                break;
            case 4:
                plans[pick(2)] =
                    made_up_plan(pick(2) == 0 ? "first" : "second", static_cast<int>(1 + pick(7)));
                plans[1].experiment = "second";
                plans[0].experiment = "first";
                for (const Plan& p : plans) {
                    if (pick(2) == 0) store_->put_experiment(p);
                }
        }
        for (const char* name : {"first", "second"}) n_from_rollups += check(name) ? 1 : 0;
        ASSERT_FALSE(HasFailure()) << "step " << step;
    }
    // The test means nothing unless rollups were there, and were not always.
    EXPECT_GT(n_from_rollups, 30);
    EXPECT_LT(n_from_rollups, 270);
}

TEST_F(RollupTest, EndsWithAChangeByAnyHand) {
    const Plan plan = made_up_plan("first", 3);
    store_->put_experiment(plan);
    store_->put_experiment(made_up_plan("second", 2));
    commit_all(*store_, plan);
    const std::string task = task_id(plan.cells.back().task);  // of seed 3: not in "second"
    for (const std::string& change :
         {"UPDATE measurements SET value = 2 * value WHERE run = '" + task + "'",
          "DELETE FROM measurements WHERE run = '" + task + "'",
          "UPDATE reference_noise SET share = 1 WHERE run = '" + task + "'",
          "UPDATE runs SET passes = 99 WHERE id = '" + task + "'",
          "UPDATE tasks SET state = 'failed' WHERE id = '" + task + "'",
          "UPDATE cells SET seed = 77 WHERE experiment = 'first' AND task = '" + task + "'",
          "DELETE FROM cells WHERE experiment = 'first' AND task = '" + task + "'"}) {
        store_->measure(plan);
        ASSERT_TRUE(check("first"));
        ASSERT_TRUE(check("second"));
        open_database(path_ / "results.sqlite", Database::Access::ReadWrite)->execute(change);
        EXPECT_FALSE(check("first")) << change;
        EXPECT_TRUE(check("second")) << change;
    }
}

TEST_F(RollupTest, ComparisonsGoWithWhatTheyWereComputedFrom) {
    const Plan plan = made_up_plan("first", 3);
    store_->put_experiment(plan);
    commit_all(*store_, plan);
    store_->measure(plan);
    StoredComparison row{.experiment = "first",
                         .metric = "mse",
                         .baseline = "plain",
                         .scene = "Box",
                         .method = "clever",
                         .budget = "16 spp",
                         .ratio = 0.5,
                         .low = 0.4,
                         .high = 0.6,
                         .p = 0.01,
                         .adjusted_p = {}};
    const auto n_rows = [this] {
        return open_database(path_ / "results.sqlite", Database::Access::ReadOnly)
            ->integer("SELECT count(*) FROM comparisons");
    };
    store_->put_comparisons({row});
    store_->put_comparisons({row});
    EXPECT_EQ(n_rows(), 1);
    store_->measure(plan);
    EXPECT_EQ(n_rows(), 1);
    store_->put_experiment(plan);
    EXPECT_EQ(n_rows(), 0);
}

TEST_F(RollupTest, RowsOfAMadeUpStoreRollUpLikeRealOnes) {
    store_.reset();
    make_rows(path_, {.n_scenes = 2, .n_methods = 3, .n_seeds = 4});
    EXPECT_FALSE(check("million"));
    roll_up(*open_database(path_ / "results.sqlite", Database::Access::ReadWrite));
    EXPECT_TRUE(check("million"));
}

TEST_F(RollupTest, ALargeStoreThatWasLeftWithoutIsRolledUpByTheFirstWhoAsks) {
    const auto is_rolled_up = [this] {
        return open_database(path_ / "results.sqlite", Database::Access::ReadOnly)
                   ->integer("SELECT rolled_up FROM experiments") == 1;
    };
    store_.reset();
    make_rows(path_, {.n_scenes = 10, .n_methods = 10, .n_seeds = kCellsWorthARollup / 100});
    {
        const FileLock somebody_writes(path_ / "lock");
        roll_up_if_left_without(path_);
        EXPECT_FALSE(is_rolled_up());
    }
    roll_up_if_left_without(path_);
    EXPECT_TRUE(is_rolled_up());
    EXPECT_TRUE(check("million"));
}

TEST_F(RollupTest, ASmallStoreIsLeftAlone) {
    store_->put_experiment(made_up_plan("first", 3));
    commit_all(*store_, made_up_plan("first", 3));
    store_.reset();
    roll_up_if_left_without(path_);
    EXPECT_FALSE(check("first"));
}

}  // namespace
}  // namespace misbench
