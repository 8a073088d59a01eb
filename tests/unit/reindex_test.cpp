#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/base/error.h"
#include "results/sqlite.h"
#include "tests/support/made_up_store.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class ReindexTest : public testing::Test {
 protected:
    ReindexTest() {
        Store store(folder(), Store::Access::ReadWrite);
        for (const Plan& plan : {first_, second_}) {
            store.put_experiment(plan);
            commit_all(store, plan);
            store.measure(plan);
        }
        last_epoch_ = store.next_epoch();
    }

    fs::path folder() const { return temporary_.path() / "store"; }
    Store read() const { return {folder(), Store::Access::ReadOnly}; }

    // All rows of all tables that the files determine, in an order of their own.
    std::vector<std::string> all_rows() const {
        const Database database(folder() / "results.sqlite", Database::Access::ReadOnly);
        std::vector<std::string> rows;
        for (const char* sql :
             {"SELECT json_array(experiment, scene, method, budget, seed, state, metric, "
              "hex(value), run, valid, passes, threads, wall_seconds, cpu_seconds, rays, "
              "parameters, worker, finished_at) FROM results ORDER BY 1",
              "SELECT json_array(name, submitted_at_ms, file_sha256) FROM experiments ORDER BY 1",
              "SELECT json_array(run, snapshot, reference_a, reference_b, metric, value) FROM "
              "measurements ORDER BY 1",
              "SELECT json_array(run, samples, passes, wall_seconds, cpu_seconds, rays) FROM "
              "snapshots ORDER BY 1",
              "SELECT json_array(run, reference_a, reference_b, share) FROM reference_noise "
              "ORDER BY 1",
              "SELECT json_array(experiment, method, seed, metric, snapshot, passes, value) FROM "
              "curves ORDER BY 1",
              "SELECT json_array(id, task, block, state) FROM tasks ORDER BY 1"}) {
            Statement select = database.prepare(sql);
            while (select.step()) rows.push_back(select.text(0));
        }
        return rows;
    }

    void delete_database() const {
        for (const char* end : {"", "-wal", "-shm"}) {
            fs::remove(folder() / (std::string("results.sqlite") + end));
        }
    }

    static Plan plan_with_snapshots() {
        Plan plan = made_up_plan("first", 3);
        for (Cell& cell : plan.cells) {
            if (cell.role == Role::Test) cell.task.snapshots = SnapshotLadder{};
        }
        return plan;
    }

    const Plan first_ = plan_with_snapshots();
    const Plan second_ = made_up_plan("second", 4, TimeBudget{0.5, BudgetClock::Cpu});
    std::int64_t last_epoch_ = 0;

 private:
    TemporaryFolder temporary_;
};

TEST_F(ReindexTest, GivesTheSameRowsAfterTheDatabaseWasDeleted) {
    const auto before = all_rows();
    EXPECT_GT(before.size(), 50U);
    delete_database();
    const Reindexed result = reindex(folder());
    EXPECT_EQ(result.runs, 2 + 3 * 2 + 4 * 2);
    EXPECT_EQ(result.experiments, 2);
    EXPECT_THAT(result.damaged, ElementsAre());
    EXPECT_EQ(all_rows(), before);
    EXPECT_THAT(read().experiments(), ElementsAre("second", "first"));
}

TEST_F(ReindexTest, ReplacesADatabaseThatIsThere) {
    const auto before = all_rows();
    {
        const Database database(folder() / "results.sqlite", Database::Access::ReadWrite);
        database.execute("UPDATE measurements SET value = 0; PRAGMA user_version = 77");
    }
    reindex(folder());
    EXPECT_EQ(all_rows(), before);
    EXPECT_FALSE(fs::exists(folder() / "results.sqlite.new"));
}

TEST_F(ReindexTest, IgnoresTheLogThatACrashLeftBesideTheOldDatabase) {
    const auto before = all_rows();
    write_file_durably(folder() / "results.sqlite-wal", std::string(8192, 'x'));
    write_file_durably(folder() / "results.sqlite-shm", std::string(8192, 'x'));
    reindex(folder());
    EXPECT_FALSE(fs::exists(folder() / "results.sqlite-wal"));
    EXPECT_EQ(all_rows(), before);
}

TEST_F(ReindexTest, WriterFindsTheRunsOfAStoreWhoseDatabaseIsGone) {
    const auto before = all_rows();
    delete_database();
    EXPECT_THROW(read(), Error);
    {
        Store store(folder(), Store::Access::ReadWrite);
        EXPECT_GT(store.measure(first_) + store.measure(second_), 0);
    }
    EXPECT_EQ(all_rows(), before);
}

TEST_F(ReindexTest, EpochsOfTheOldDatabaseNeverComeAgain) {
    delete_database();
    reindex(folder());
    EXPECT_GT(Store(folder(), Store::Access::ReadWrite).next_epoch(), last_epoch_);
}

TEST_F(ReindexTest, EpochsStayAboveThoseOfTheRunsWhenTheClockWasSetBack) {
    const std::int64_t future = last_epoch_ * 2;
    {
        Store store(folder(), Store::Access::ReadWrite);
        commit_made_up_run(store, made_up_task("plain", 50, SampleBudget{16}),
                           [future](Record& record) { record.epoch = future; });
    }
    delete_database();
    reindex(folder());
    EXPECT_EQ(Store(folder(), Store::Access::ReadWrite).next_epoch(), future + 1);
}

TEST_F(ReindexTest, SetsDamagedFilesAsideAndNamesThem) {
    const std::string lost_record = task_id(first_.cells[2].task);
    const std::string lost_image = task_id(first_.cells[3].task);
    const std::string renamed = task_id(first_.cells[4].task);
    const fs::path runs = folder() / "runs";
    write_file_durably(runs / lost_record / "record.json", "{}");
    const std::string bytes = read_file(runs / lost_image / "image.exr");
    write_file_durably(runs / lost_image / "image.exr", bytes.substr(0, bytes.size() - 1));
    fs::rename(runs / renamed, runs / "a-copy");
    write_file_durably(folder() / "experiments" / "second.json", "no JSON");
    const Reindexed result = reindex(folder());
    EXPECT_THAT(result.damaged,
                testing::UnorderedElementsAre("runs/" + lost_record, "runs/" + lost_image,
                                              "runs/a-copy", "experiments/second.json"));
    EXPECT_TRUE(fs::exists(folder() / "damaged" / lost_image / "image.exr"));
    const Store store = read();
    EXPECT_THAT(store.experiments(), ElementsAre("first"));
    EXPECT_EQ(store.task(lost_image)->state, TaskState::Pending);
    EXPECT_EQ(store.measurements(first_).size(), 2U * (6 - 3));
}

TEST_F(ReindexTest, RefusesAFolderThatIsNoStore) {
    const fs::path other = folder().parent_path() / "other";
    fs::create_directories(other);
    try {
        reindex(other);
        ADD_FAILURE() << "reindexed";
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), Errc::NotFound);
        EXPECT_THAT(e.what(), HasSubstr("it has no runs/"));
    }
    EXPECT_TRUE(fs::is_empty(other));
}

}  // namespace
}  // namespace misbench
