// The coordinator in virtual time on a real store, with runs made up by the test.
#include "coordinator/task_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <spdlog/spdlog.h>

#include <atomic>
#include <optional>
#include <thread>

#include "renderer/base/build_info.h"
#include "renderer/base/error.h"
#include "tests/support/made_up_store.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;

constexpr seconds kTtl{10};
constexpr int kTasks = 6;  // two halves of a reference, two seeds of two methods

struct Files {
    std::string image, record;
    std::vector<QueueClient::Artefact> artefacts() const {
        return {{"image.exr", static_cast<std::int64_t>(image.size()), sha256_hex(image)},
                {"record.json", static_cast<std::int64_t>(record.size()), sha256_hex(record)}};
    }
};

class TaskQueueTest : public testing::Test {
 protected:
    TaskQueueTest() {
        spdlog::set_level(spdlog::level::off);
        start();
        plan_ = made_up_plan("first", 2);
        queue_->submit(plan_, now_);
    }

    void start() {
        queue_.emplace(Store(store_path(), Store::Access::ReadWrite), LeasePolicy{.ttl = kTtl},
                       now_);
    }
    void restart() {
        queue_.reset();
        start();
    }
    fs::path store_path() const { return folder_.path() / "store"; }
    Store look() const { return {store_path(), Store::Access::ReadOnly}; }

    Instruction call(const std::string& worker, const WorkerReport& report = {}) {
        return queue_->synchronize(worker, build_id(), report, now_);
    }
    Instruction::Begin must_begin(const std::string& worker) {
        const Instruction instruction = call(worker);
        if (const auto* begin = std::get_if<Instruction::Begin>(&instruction.next)) return *begin;
        ADD_FAILURE() << worker << " was given no task";
        return {};
    }
    bool renewed(const std::string& worker, const LeaseRef& lease) {
        const Instruction answer = call(worker, {.doing = WorkerReport::Working{lease}});
        return std::holds_alternative<Instruction::GoOn>(answer.next);
    }

    Files make_files(const Instruction::Begin& begin) {
        const fs::path image = folder_.path() / (begin.lease.task + ".exr");
        write_exr(image, made_up_image(begin.task));
        Files files{.image = read_file(image), .record = ""};
        Record record = made_up_record(begin.task);
        record.epoch = begin.lease.epoch;
        record.image_sha256 = sha256_hex(files.image);
        files.record = record_to_json(record).dump();
        return files;
    }
    void upload(const LeaseRef& lease, const Files& files) {
        queue_->upload(lease, "image.exr", 0, files.image, now_);
        queue_->upload(lease, "record.json", 0, files.record, now_);
    }
    CommitOutcome deliver(const Instruction::Begin& begin) {
        const Files files = make_files(begin);
        upload(begin.lease, files);
        return queue_->commit(begin.lease, files.artefacts(), now_);
    }

    template <typename Body>
    static Errc code_of(Body&& body) {
        try {
            body();
        } catch (const Error& error) {
            return error.code();
        }
        ADD_FAILURE() << "no error";
        return Errc::Internal;
    }

    TemporaryFolder folder_;
    Plan plan_;
    std::chrono::steady_clock::time_point now_{std::chrono::hours(1)};
    std::optional<TaskQueue> queue_;
};

TEST_F(TaskQueueTest, WorkerDoesTheWholeExperimentAndIsThenToldToWait) {
    for (int i = 0; i < kTasks; ++i) EXPECT_EQ(deliver(must_begin("w")), CommitOutcome::Accepted);
    EXPECT_TRUE(std::holds_alternative<Instruction::Wait>(call("w").next));
    const QueueStatus status = queue_->status("first", now_);
    EXPECT_EQ(status.done, kTasks);
    EXPECT_EQ(status.pending + status.leased + status.failed, 0);
    EXPECT_EQ(status.finished.size(), std::size_t{kTasks});
    const Store store = look();
    for (const Cell& cell : plan_.cells) EXPECT_TRUE(store.has_run(task_id(cell.task)));
}

TEST_F(TaskQueueTest, StatusShowsTheUsersLabelsAndWhoDoesWhat) {
    const auto begin = must_begin("w");
    now_ += seconds(2);
    const QueueStatus status = queue_->status("first", now_);
    EXPECT_EQ(status.pending, kTasks - 1);
    ASSERT_EQ(status.running.size(), 1U);
    EXPECT_EQ(status.running[0].worker, "w");
    EXPECT_EQ(status.running[0].task, begin.lease.task);
    EXPECT_EQ(status.running[0].method, "reference");
    EXPECT_EQ(status.running[0].since, seconds(2));
    EXPECT_EQ(queue_->status("", now_).running[0].method, "plain");
    EXPECT_EQ(code_of([&] { queue_->status("second", now_); }), Errc::NotFound);
}

TEST_F(TaskQueueTest, CallThatWaitedForItsTurnDoesNotTurnTimeBack) {
    must_begin("w");
    EXPECT_EQ(queue_->status("first", now_ - seconds(1)).running.at(0).since, seconds(0));
    now_ += kTtl;
    EXPECT_EQ(queue_->status("first", now_).leased, 0);
    call("other", {});
    EXPECT_EQ(queue_->status("first", now_ - kTtl).leased, 1);
}

TEST_F(TaskQueueTest, GrantIsOnDiskBeforeItIsTold) {
    const auto begin = must_begin("w");
    const auto row = look().task(begin.lease.task);
    ASSERT_TRUE(row.has_value());
    EXPECT_EQ(row->state, TaskState::Leased);
    EXPECT_EQ(row->epoch, begin.lease.epoch);
    EXPECT_EQ(row->worker, "w");
}

TEST_F(TaskQueueTest, RestartInMidRunContinues) {
    EXPECT_EQ(deliver(must_begin("a")), CommitOutcome::Accepted);
    const auto held = must_begin("a");
    const Files files = make_files(held);
    queue_->upload(held.lease, "image.exr", 0, files.image, now_);

    restart();
    EXPECT_TRUE(renewed("a", held.lease));
    const auto other = must_begin("b");
    EXPECT_NE(other.lease.task, held.lease.task);
    EXPECT_GT(other.lease.epoch, held.lease.epoch);
    // What had been uploaded is gone, and the worker is told so.
    EXPECT_EQ(code_of([&] { queue_->commit(held.lease, files.artefacts(), now_); }),
              Errc::DataLoss);
    upload(held.lease, files);
    EXPECT_EQ(queue_->commit(held.lease, files.artefacts(), now_), CommitOutcome::Accepted);
    EXPECT_EQ(queue_->status("first", now_).done, 2);
}

TEST_F(TaskQueueTest, LeaseOfADeadWorkerRunsOutAfterARestartToo) {
    const auto held = must_begin("a");
    restart();
    now_ += kTtl;
    const auto again = must_begin("b");
    EXPECT_EQ(again.lease.task, held.lease.task);
    EXPECT_GT(again.lease.epoch, held.lease.epoch);
    EXPECT_FALSE(renewed("a", held.lease));
    EXPECT_EQ(look().task(held.lease.task)->losses, 1);
}

TEST_F(TaskQueueTest, CommittingTwiceKeepsTheFirst) {
    const auto begin = must_begin("w");
    const Files files = make_files(begin);
    upload(begin.lease, files);
    EXPECT_EQ(queue_->commit(begin.lease, files.artefacts(), now_), CommitOutcome::Accepted);
    EXPECT_EQ(queue_->commit(begin.lease, files.artefacts(), now_), CommitOutcome::AlreadyDone);
    restart();
    EXPECT_EQ(queue_->commit(begin.lease, files.artefacts(), now_), CommitOutcome::AlreadyDone);
    EXPECT_EQ(queue_->status("first", now_).done, 1);
}

TEST_F(TaskQueueTest, StaleCommitIsRefused) {
    const auto zombie = must_begin("zombie");
    const Files files = make_files(zombie);
    upload(zombie.lease, files);
    now_ += kTtl;
    const auto heir = must_begin("heir");
    ASSERT_EQ(heir.lease.task, zombie.lease.task);

    EXPECT_EQ(queue_->commit(zombie.lease, files.artefacts(), now_), CommitOutcome::Stale);
    EXPECT_EQ(code_of([&] { queue_->upload(zombie.lease, "image.exr", 0, "x", now_); }),
              Errc::FailedPrecondition);
    EXPECT_EQ(queue_->status("first", now_).done, 0);
    EXPECT_EQ(deliver(heir), CommitOutcome::Accepted);
    EXPECT_EQ(look().run(heir.lease.task)->epoch, heir.lease.epoch);
}

TEST_F(TaskQueueTest, LateResultOfATaskThatNobodyElseHasIsKept) {
    const auto begin = must_begin("slow");
    now_ += 3 * kTtl;
    EXPECT_EQ(queue_->status("first", now_).leased, 0);
    EXPECT_EQ(deliver(begin), CommitOutcome::Accepted);
}

TEST_F(TaskQueueTest, DamagedUploadIsRefusedByItsHashAndCanBeSentAgain) {
    const auto begin = must_begin("w");
    const Files good = make_files(begin);
    Files bad = good;
    bad.image[bad.image.size() / 2] ^= 1;
    upload(begin.lease, bad);
    EXPECT_EQ(code_of([&] { queue_->commit(begin.lease, good.artefacts(), now_); }),
              Errc::DataLoss);
    EXPECT_FALSE(look().has_run(begin.lease.task));

    upload(begin.lease, good);
    EXPECT_EQ(queue_->commit(begin.lease, good.artefacts(), now_), CommitOutcome::Accepted);
}

TEST_F(TaskQueueTest, IncompleteOrForeignResultIsRefused) {
    const auto begin = must_begin("w");
    const Files files = make_files(begin);
    upload(begin.lease, files);
    auto only_image = files.artefacts();
    only_image.pop_back();
    EXPECT_EQ(code_of([&] { queue_->commit(begin.lease, only_image, now_); }),
              Errc::InvalidArgument);

    const auto other = must_begin("other");
    const Files foreign = make_files(other);
    upload(begin.lease, foreign);
    EXPECT_EQ(code_of([&] { queue_->commit(begin.lease, foreign.artefacts(), now_); }),
              Errc::InvalidArgument);
    EXPECT_FALSE(look().has_run(other.lease.task));
}

TEST_F(TaskQueueTest, SnapshotsAreThoseThatTheRecordNames) {
    const auto begin = must_begin("w");
    const Files files = make_files(begin);
    auto artefacts = files.artefacts();
    artefacts.push_back({"snapshot-000002.exr", 5, sha256_hex("noise")});
    upload(begin.lease, files);
    queue_->upload(begin.lease, "snapshot-000002.exr", 0, "noise", now_);
    EXPECT_EQ(code_of([&] { queue_->commit(begin.lease, artefacts, now_); }),
              Errc::InvalidArgument);
    EXPECT_EQ(deliver(begin), CommitOutcome::Accepted);
}

TEST_F(TaskQueueTest, UploadGoesOnAtTheOffsetThatIsThere) {
    const auto begin = must_begin("w");
    const LeaseRef& lease = begin.lease;
    const Files files = make_files(begin);
    const std::int64_t half = 100;
    EXPECT_EQ(queue_->upload(lease, "image.exr", 0, files.image.substr(0, half), now_), half);
    // The same chunk again and one too far ahead change nothing.
    EXPECT_EQ(queue_->upload(lease, "image.exr", 0, files.image.substr(0, half), now_), half);
    EXPECT_EQ(queue_->upload(lease, "image.exr", half + 5, "later", now_), half);
    EXPECT_EQ(queue_->upload(lease, "image.exr", half, files.image.substr(half), now_),
              static_cast<std::int64_t>(files.image.size()));
    queue_->upload(lease, "record.json", 0, files.record, now_);
    EXPECT_EQ(queue_->commit(lease, files.artefacts(), now_), CommitOutcome::Accepted);
    EXPECT_EQ(look().run_image(lease.task), made_up_image(begin.task));
}

TEST_F(TaskQueueTest, UploadKeepsTheLeaseAlive) {
    const auto begin = must_begin("w");
    for (int i = 0; i < 5; ++i) {
        now_ += kTtl - seconds(1);
        queue_->upload(begin.lease, "image.exr", i, "x", now_);
    }
    EXPECT_EQ(queue_->status("first", now_).leased, 1);
}

TEST_F(TaskQueueTest, FailureIsReportedWithItsErrorAfterTheSecondAttempt) {
    const auto first = must_begin("w");
    const auto next = call("w", {.doing = WorkerReport::Failed{first.lease, "no luck"}});
    ASSERT_TRUE(std::holds_alternative<Instruction::Begin>(next.next));
    EXPECT_NE(std::get<Instruction::Begin>(next.next).lease.task, first.lease.task);
    // The other worker first does what it has; the retry comes when that is done.
    auto second = must_begin("other");
    for (int i = 0; i < kTasks && second.lease.task != first.lease.task; ++i) {
        deliver(second);
        second = must_begin("other");
    }
    ASSERT_EQ(second.lease.task, first.lease.task);
    call("other", {.doing = WorkerReport::Failed{second.lease, "none again"}});

    const QueueStatus status = queue_->status("first", now_);
    EXPECT_EQ(status.failed, 1);
    ASSERT_EQ(status.failures.size(), 1U);
    EXPECT_EQ(status.failures[0].task, first.lease.task);
    EXPECT_EQ(status.failures[0].error, "none again");
    EXPECT_EQ(status.failures[0].scene, "Box");
    // It is for the user to try again.
    queue_->submit(plan_, now_);
    EXPECT_EQ(queue_->status("first", now_).failed, 0);
}

TEST_F(TaskQueueTest, WorkerThatLeavesGivesItsTaskBackAndIsToldToExit) {
    const auto begin = must_begin("leaver");
    const Instruction answer =
        call("leaver", {.doing = WorkerReport::Released{begin.lease}, .leaving = true});
    EXPECT_TRUE(std::holds_alternative<Instruction::Exit>(answer.next));
    EXPECT_EQ(must_begin("other").lease.task, begin.lease.task);
    EXPECT_EQ(look().task(begin.lease.task)->failures, 0);
    EXPECT_EQ(look().task(begin.lease.task)->losses, 0);
}

TEST_F(TaskQueueTest, LeaseGoesOnWhenAnExperimentIsAdded) {
    const auto begin = must_begin("w");
    const SubmitResult result = queue_->submit(made_up_plan("second", 3), now_);
    EXPECT_EQ(result.tasks, kTasks + 2);
    EXPECT_EQ(result.cached, 0);
    EXPECT_EQ(deliver(begin), CommitOutcome::Accepted);
    EXPECT_EQ(queue_->submit(plan_, now_).cached, 1);
}

TEST_F(TaskQueueTest, ManyWorkersAtOnceMakeEveryRunOnce) {
    const Plan plan = made_up_plan("large", 20);
    queue_->submit(plan, now_);
    std::atomic<int> n_accepted = 0;
    std::vector<std::jthread> workers;
    for (int i = 0; i < 4; ++i) {
        workers.emplace_back([&, name = "w" + std::to_string(i)] {
            while (true) {
                const Instruction instruction = call(name);
                const auto* begin = std::get_if<Instruction::Begin>(&instruction.next);
                if (begin == nullptr) return;
                EXPECT_TRUE(renewed(name, begin->lease));
                if (deliver(*begin) == CommitOutcome::Accepted) ++n_accepted;
                queue_->status("large", now_);
            }
        });
    }
    workers.clear();
    const QueueStatus status = queue_->status("large", now_);
    EXPECT_EQ(status.done, static_cast<std::int64_t>(plan.cells.size()));
    EXPECT_EQ(n_accepted, status.done);
    EXPECT_EQ(status.finished.size(), plan.cells.size());
}

TEST_F(TaskQueueTest, WorkerOfAnotherBuildIsTurnedAway) {
    try {
        queue_->synchronize("w", "another", {}, now_);
        FAIL() << "it was admitted";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), Errc::FailedPrecondition);
        EXPECT_EQ(std::string(error.what()),
                  std::string("admit worker 'w': its build is 'another'; the coordinator's is '")
                      .append(build_id())
                      .append("'"));
    }
}

}  // namespace
}  // namespace misbench
