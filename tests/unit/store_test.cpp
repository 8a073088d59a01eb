#include "results/store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <set>

#include "renderer/base/error.h"
#include "tests/support/store_fixture.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

// --- runs --------------------------------------------------------------------------------------

TEST_F(StoreTest, GivesBackARunAsItWasCommitted) {
    Store store = open();
    const std::string id = task_id(task_);
    EXPECT_FALSE(store.has_run(id));
    EXPECT_EQ(store.run(id), std::nullopt);
    const fs::path staged = stage_made_up_run(store, task_);
    EXPECT_EQ(store.commit_run(staged), Recorded::New);
    EXPECT_FALSE(fs::exists(staged));
    ASSERT_TRUE(store.has_run(id));
    EXPECT_EQ(store.run(id)->statistics.cpu_seconds, 2.75);
    EXPECT_EQ(store.run_image(id), made_up_image(task_));
    EXPECT_EQ(store.run_summaries().at(id).passes, 16);
}

TEST_F(StoreTest, RecordingTheSameRunTwiceKeepsTheFirst) {
    Store store = open();
    store.put_experiment(plan_);
    commit_made_up_run(store, task_, [](Record& record) { record.worker = "the first"; });
    const fs::path second =
        stage_made_up_run(store, task_, [](Record& record) { record.worker = "the second"; });
    EXPECT_EQ(store.commit_run(second), Recorded::AlreadyThere);
    EXPECT_FALSE(fs::exists(second));
    EXPECT_EQ(store.run(task_id(task_))->worker, "the first");
}

TEST_F(StoreTest, CommitRefusesADamagedRun) {
    Store store = open();
    const fs::path short_record = stage_made_up_run(store, task_);
    const std::string bytes = read_file(short_record / "record.json");
    write_file_durably(short_record / "record.json", bytes.substr(0, bytes.size() / 2));
    EXPECT_THAT(message_of(Errc::DataLoss, [&] { store.commit_run(short_record); }),
                HasSubstr("record.json': it is not whole JSON"));

    const fs::path other_image = stage_made_up_run(store, task_);
    write_exr(other_image / "image.exr", Image(8, 4));
    EXPECT_THAT(message_of(Errc::DataLoss, [&] { store.commit_run(other_image); }),
                HasSubstr("image.exr': its bytes are not those its record names"));

    const fs::path no_image = stage_made_up_run(store, task_);
    fs::remove(no_image / "image.exr");
    message_of(Errc::DataLoss, [&] { store.commit_run(no_image); });
    EXPECT_FALSE(store.has_run(task_id(task_)));
    EXPECT_EQ(commit_made_up_run(store, task_), Recorded::New);
}

TEST_F(StoreTest, CommitChecksAndKeepsTheSnapshots) {
    Store store = open();
    Task task = task_;
    task.snapshots = SnapshotLadder{};
    const fs::path damaged = stage_made_up_run(store, task);
    write_exr(damaged / "snapshot-000004.exr", Image(8, 4));
    EXPECT_THAT(message_of(Errc::DataLoss, [&] { store.commit_run(damaged); }),
                HasSubstr("snapshot-000004.exr': its bytes are not those its record names"));
    fs::remove(damaged / "snapshot-000004.exr");
    message_of(Errc::DataLoss, [&] { store.commit_run(damaged); });

    EXPECT_EQ(commit_made_up_run(store, task), Recorded::New);
    EXPECT_EQ(store.run(task_id(task))->snapshots.size(), 4U) << "after 1, 2, 4 and 8 samples";
    EXPECT_EQ(store.snapshot_image(task_id(task), 4), made_up_snapshot_image(task, 4));
    EXPECT_FALSE(store.has_run(task_id(task_))) << "one without snapshots is another run";
}

TEST_F(StoreTest, RunThatACrashLeftWithoutARowIsIndexedByTheNextWriter) {
    const std::string id = task_id(task_);
    {
        Store store = open();
        store.put_experiment(plan_);
        publish_folder(stage_made_up_run(store, task_), store.run_folder(id));
        EXPECT_FALSE(store.has_run(id));
    }
    Store store = open();
    EXPECT_TRUE(store.has_run(id));
    EXPECT_EQ(store.task(id)->state, TaskState::Done);
}

TEST_F(StoreTest, CommitGoesOnWhereAnEarlierOneFailedAtTheDatabase) {
    Store store = open();
    const std::string id = task_id(task_);
    publish_folder(stage_made_up_run(store, task_, [](Record& r) { r.worker = "the first"; }),
                   store.run_folder(id));
    EXPECT_EQ(commit_made_up_run(store, task_), Recorded::AlreadyThere);
    EXPECT_EQ(store.run(id)->worker, "the first");
}

TEST_F(StoreTest, RunWhoseFilesCannotBePublishedHasNoRow) {
    Store store = open();
    store.put_experiment(plan_);
    const std::string id = task_id(task_);
    fs::create_symlink("nowhere", store.run_folder(id));
    message_of(Errc::DataLoss, [&] { commit_made_up_run(store, task_); });
    EXPECT_FALSE(store.has_run(id));
    EXPECT_EQ(store.task(id)->state, TaskState::Pending);
    fs::remove(store.run_folder(id));
    EXPECT_EQ(commit_made_up_run(store, task_), Recorded::New);
}

TEST_F(StoreTest, DamagedRunDirectoryWithoutARowIsSetAsideAndTheTaskCanBeDoneAgain) {
    const std::string id = task_id(task_);
    {
        Store store = open();
        publish_folder(stage_made_up_run(store, task_), store.run_folder(id));
        write_file_durably(store.run_folder(id) / "record.json", "{");
    }
    Store store = open();
    EXPECT_FALSE(store.has_run(id));
    EXPECT_TRUE(fs::exists(folder() / "damaged" / id / "image.exr"));
    EXPECT_EQ(commit_made_up_run(store, task_), Recorded::New);
}

TEST_F(StoreTest, UploadsInProgressAreGoneWhenAWriterOpens) {
    fs::path staged;
    {
        Store store = open();
        staged = stage_made_up_run(store, task_);
    }
    EXPECT_TRUE(fs::exists(staged));
    open();
    EXPECT_FALSE(fs::exists(staged));
}

TEST_F(StoreTest, KnowsWhatASampleCosts) {
    Store store = open();
    EXPECT_EQ(store.seconds_per_sample(task_.scene_hash, "plain"), std::nullopt);
    commit_made_up_run(store, task_);
    const double samples = 16.0 * 8 * 4;
    EXPECT_DOUBLE_EQ(store.seconds_per_sample(task_.scene_hash, "plain").value(), 2.75 / samples);
    EXPECT_EQ(store.seconds_per_sample(task_.scene_hash, "clever"), std::nullopt);
}

// --- experiments and tasks ---------------------------------------------------------------------

TEST_F(StoreTest, GivesBackAnExperimentAndItsTasksInTheOrderOfThePlan) {
    Store store = open();
    store.put_experiment(plan_);
    EXPECT_EQ(store.experiment("first"), plan_);
    EXPECT_EQ(store.experiment(""), plan_);
    const auto rows = store.tasks();
    ASSERT_EQ(rows.size(), plan_.cells.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_EQ(rows[i].task, plan_.cells[i].task);
        EXPECT_EQ(rows[i].id, task_id(plan_.cells[i].task));
        EXPECT_EQ(rows[i].state, TaskState::Pending);
    }
}

TEST_F(StoreTest, MethodsOfOneSceneAndSeedFormABlockApartFromTheReference) {
    Store store = open();
    store.put_experiment(plan_);
    std::map<std::string, std::set<std::string>> methods;
    for (const TaskRow& row : store.tasks()) methods[row.block].insert(row.task.method);
    EXPECT_EQ(methods.size(), 3U + 2U);
    int n_whole = 0;
    for (const auto& [block, of_block] : methods) n_whole += of_block.size() == 2 ? 1 : 0;
    EXPECT_EQ(n_whole, 3);
}

TEST_F(StoreTest, PuttingAnExperimentAgainChangesNothing) {
    Store store = open();
    store.put_experiment(plan_);
    commit_made_up_run(store, task_);
    TaskRow leased = store.tasks().back();
    leased.state = TaskState::Leased;
    leased.epoch = store.next_epoch();
    leased.worker = "somebody";
    leased.losses = 1;
    store.save_task_state(leased);
    store.put_experiment(plan_);
    EXPECT_EQ(store.tasks().size(), plan_.cells.size());
    EXPECT_EQ(store.task(task_id(task_))->state, TaskState::Done);
    const TaskRow again = store.task(leased.id).value();
    EXPECT_EQ(again.state, TaskState::Leased);
    EXPECT_EQ(again.epoch, leased.epoch);
    EXPECT_EQ(again.losses, 1);
    EXPECT_EQ(again.position, leased.position);
}

TEST_F(StoreTest, FailedTaskThatIsPlannedAgainGetsAnotherChance) {
    Store store = open();
    store.put_experiment(plan_);
    TaskRow row = store.tasks().back();
    row.state = TaskState::Failed;
    row.failures = 3;
    row.losses = 2;
    row.epoch = 9;
    row.error = "out of memory";
    store.save_task_state(row);
    EXPECT_EQ(store.task(row.id)->error, "out of memory");
    store.put_experiment(plan_);
    const TaskRow again = store.task(row.id).value();
    EXPECT_EQ(again.state, TaskState::Pending);
    EXPECT_EQ(again.failures, 0);
    EXPECT_EQ(again.losses, 0);
    EXPECT_EQ(again.error, "");
    EXPECT_EQ(again.epoch, 9);
}

TEST_F(StoreTest, ExperimentsThatShareTasksShareRuns) {
    Store store = open();
    store.put_experiment(plan_);
    commit_all(store, plan_);
    store.put_experiment(made_up_plan("second", 5));
    EXPECT_THAT(store.experiments(), ElementsAre("second", "first"));
    int n_done = 0;
    int n_pending = 0;
    for (const TaskRow& row : store.tasks()) {
        n_done += row.state == TaskState::Done ? 1 : 0;
        n_pending += row.state == TaskState::Pending ? 1 : 0;
    }
    EXPECT_EQ(n_done, 2 + 3 * 2);
    EXPECT_EQ(n_pending, 2 * 2);
    store.put_experiment(plan_);
    EXPECT_THAT(store.experiments(), ElementsAre("first", "second"));
}

TEST_F(StoreTest, TasksThatNoExperimentAsksForLeaveUnlessAWorkerIsAtThem) {
    Store store = open();
    store.put_experiment(made_up_plan("first", 5));
    TaskRow leased = store.tasks().back();
    leased.state = TaskState::Leased;
    store.save_task_state(leased);
    store.put_experiment(made_up_plan("first", 1));
    EXPECT_EQ(store.tasks().size(), 2U + 2U + 1U);
    EXPECT_TRUE(store.task(leased.id));
}

TEST_F(StoreTest, ExperimentWhoseRowsACrashLeftOutIsIndexedByTheNextWriter) {
    {
        Store store = open();
        store.put_experiment(plan_);
        store.put_experiment(made_up_plan("second", 1));
    }
    // As if the crash came after the file of a new version was written.
    const std::string other = R"({"format": 1, "submitted_at_ms": 9999999999999, "plan": )" +
                              plan_to_json(made_up_plan("second", 4)).dump() + "}";
    write_file_durably(folder() / "experiments" / "second.json", other);
    Store store = open();
    EXPECT_EQ(store.tasks().size(), 2U + 4U * 2U);
}

TEST_F(StoreTest, UnknownExperimentIsAnErrorThatListsTheKnown) {
    Store store = open();
    EXPECT_THAT(message_of(Errc::NotFound, [&] { std::ignore = store.experiment(""); }),
                HasSubstr("has no experiments"));
    store.put_experiment(plan_);
    EXPECT_EQ(message_of(Errc::NotFound, [&] { std::ignore = store.experiment("frist"); }),
              "unknown experiment 'frist'; known: first");
}

TEST_F(StoreTest, RefusesAnExperimentNameThatIsNoFileName) {
    Store store = open();
    for (const char* name : {"", "../evil", ".hidden", "a b"}) {
        EXPECT_THAT(
            message_of(Errc::InvalidArgument, [&] { store.put_experiment(made_up_plan(name, 1)); }),
            HasSubstr("'" + std::string(name) + "'"));
    }
}

TEST_F(StoreTest, EpochsGrowOverTheLifeOfTheStoreAndStartAtTheClock) {
    const auto now = std::chrono::duration_cast<std::chrono::milliseconds>(
                         std::chrono::system_clock::now().time_since_epoch())
                         .count();
    std::int64_t last = 0;
    for (int opened = 0; opened < 2; ++opened) {
        Store store = open();
        for (int i = 0; i < 3; ++i) {
            const std::int64_t epoch = store.next_epoch();
            EXPECT_GE(epoch, now);
            EXPECT_GT(epoch, last);
            last = epoch;
        }
    }
}

}  // namespace
}  // namespace misbench
