// The worker's conversation with a coordinator, a renderer and a clock that the test plays.
#include "worker/session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <deque>
#include <mutex>
#include <thread>

#include "renderer/base/error.h"
#include "renderer/base/files.h"
#include "renderer/base/sha256.h"
#include "tests/support/made_up_store.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;

const LeaseRef kFirst{std::string(32, 'a'), 1};
const LeaseRef kSecond{std::string(32, 'b'), 2};

Error away() { return {Errc::Unavailable, "nobody there"}; }
Instruction begin(const LeaseRef& lease) {
    return {Instruction::Begin{lease, {}}, milliseconds(20)};
}

std::string describe(const WorkerReport& report) {
    const std::string leaving = report.leaving ? " leaving" : "";
    if (const auto* working = std::get_if<WorkerReport::Working>(&report.doing)) {
        return "working " + std::to_string(working->lease.epoch) + leaving;
    }
    if (const auto* failed = std::get_if<WorkerReport::Failed>(&report.doing)) {
        return "failed " + std::to_string(failed->lease.epoch) + ": " + failed->error + leaving;
    }
    if (const auto* released = std::get_if<WorkerReport::Released>(&report.doing)) {
        return "released " + std::to_string(released->lease.epoch) + leaving;
    }
    return "idle" + leaving;
}

// Answers are scripted; what was said is written down. Time moves only by pauses.
class SessionTest : public testing::Test {
 protected:
    SessionTest() { spdlog::set_level(spdlog::level::off); }

    using Step = std::function<Instruction()>;
    using Commit = std::function<CommitOutcome()>;

    void run(milliseconds patience = seconds(60)) {
        Session session(
            {.synchronize = [this](const WorkerReport& report) { return synchronize(report); },
             .upload =
                 [this](const LeaseRef& lease, const std::string& file, const std::string& bytes) {
                     uploads_.push_back(std::to_string(lease.epoch) + " " + file + " " + bytes);
                     if (upload_) upload_();
                 },
             .commit =
                 [this](const LeaseRef&, const std::vector<QueueClient::Artefact>& artefacts) {
                     artefacts_ = artefacts;
                     return next(commits_, [] { return CommitOutcome::Accepted; })();
                 },
             .run = [this](const LeaseRef& lease, const Task&,
                           const std::function<bool()>& abandon) { return task_(lease, abandon); },
             .now = [this] { return std::chrono::steady_clock::time_point(time_.load()); },
             .pause = [this](milliseconds pause,
                             const std::stop_token& stop) { this->pause(pause, stop); }},
            patience);
        session.run(stop_.get_token());
    }

    // Heartbeats are answered apart, because nobody can say how many there will be.
    Instruction synchronize(const WorkerReport& report) {
        const std::scoped_lock lock(mutex_);
        if (const auto* working = std::get_if<WorkerReport::Working>(&report.doing)) {
            ++n_heartbeats_;
            return heartbeat_ ? heartbeat_() : Instruction{Instruction::GoOn{working->lease}, {}};
        }
        said_.push_back(describe(report));
        return next(script_, [] { return Instruction{Instruction::Exit{}, {}}; })();
    }

    void pause(milliseconds pause, const std::stop_token& stop) {
        time_ = time_.load() + pause;
        if (!stop.stop_requested()) std::this_thread::yield();
    }

    template <typename Item>
    static Item next(std::deque<Item>& items, std::type_identity_t<Item> otherwise) {
        if (items.empty()) return otherwise;
        Item item = items.front();
        items.pop_front();
        return item;
    }

    TaskFinished finish(const LeaseRef& lease) {
        const fs::path folder = folder_.path() / std::to_string(lease.epoch);
        fs::create_directories(folder);
        write_file_durably(folder / "image.exr", "pixels");
        write_file_durably(folder / "record.json", "facts");
        return {folder};
    }
    bool scratch_is_empty() const { return fs::is_empty(folder_.path()); }

    TemporaryFolder folder_;
    std::stop_source stop_;
    std::mutex mutex_;
    std::deque<Step> script_;     // then Exit
    Step heartbeat_;              // default: go on
    std::deque<Commit> commits_;  // then Accepted
    std::function<void()> upload_;
    std::function<TaskOutcome(const LeaseRef&, const std::function<bool()>&)> task_ =
        [this](const LeaseRef& lease, const std::function<bool()>&) { return finish(lease); };
    std::vector<std::string> said_, uploads_;
    std::vector<QueueClient::Artefact> artefacts_;
    std::atomic<int> n_heartbeats_ = 0;
    std::atomic<std::chrono::steady_clock::duration> time_{};
};

TEST_F(SessionTest, DoesTasksUntilItIsToldToExit) {
    script_ = {[] {
                   return Instruction{Instruction::Wait{}, milliseconds(50)};
               },
               [] { return begin(kFirst); }, [] { return begin(kSecond); }};
    run();
    EXPECT_THAT(said_, testing::ElementsAre("idle", "idle", "idle", "idle"));
    EXPECT_THAT(uploads_, testing::ElementsAre("1 image.exr pixels", "1 record.json facts",
                                               "2 image.exr pixels", "2 record.json facts"));
    ASSERT_EQ(artefacts_.size(), 2U);
    EXPECT_EQ(artefacts_[0].file, "image.exr");
    EXPECT_EQ(artefacts_[0].size, 6);
    EXPECT_EQ(artefacts_[0].sha256, sha256_hex("pixels"));
    EXPECT_TRUE(scratch_is_empty());
}

TEST_F(SessionTest, DeliversTheSnapshotsOfATaskToo) {
    task_ = [this](const LeaseRef& lease, const std::function<bool()>&) {
        const TaskFinished finished = finish(lease);
        write_file_durably(finished.folder / "snapshot-000002.exr", "noise");
        write_file_durably(finished.folder / "scratch.txt", "nobody's");
        return finished;
    };
    script_ = {[] { return begin(kFirst); }};
    run();
    EXPECT_THAT(uploads_, testing::ElementsAre("1 image.exr pixels", "1 record.json facts",
                                               "1 snapshot-000002.exr noise"));
    ASSERT_EQ(artefacts_.size(), 3U);
    EXPECT_EQ(artefacts_[2].sha256, sha256_hex("noise"));
}

TEST_F(SessionTest, ResultWaitsForACoordinatorThatIsAway) {
    int n_tries = 0;
    upload_ = [&] {
        if (++n_tries <= 5) throw away();
    };
    script_ = {[] { return begin(kFirst); }};
    run();
    EXPECT_THAT(said_, testing::ElementsAre("idle", "idle"));
    EXPECT_EQ(n_tries, 7);
    EXPECT_EQ(artefacts_.size(), 2U);
}

TEST_F(SessionTest, CommitWithoutAnAnswerIsMadeAgainWithoutAnotherUpload) {
    script_ = {[] { return begin(kFirst); }};
    commits_ = {[]() -> CommitOutcome { throw away(); }, [] { return CommitOutcome::AlreadyDone; }};
    run();
    EXPECT_EQ(uploads_.size(), 2U);
    EXPECT_TRUE(commits_.empty());
}

TEST_F(SessionTest, PausesGrowUpToALimit) {
    script_ = {[]() -> Instruction { throw away(); }};
    for (int i = 0; i < 11; ++i) script_.push_back(script_.front());
    run(seconds(600));
    // 0.1 + 0.2 + 0.4 + 0.8 + 1.6 + 3.2, then 5 seconds each.
    EXPECT_EQ(time_.load(), milliseconds(6'300) + 6 * seconds(5));
}

TEST_F(SessionTest, GivesUpACoordinatorThatStaysAway) {
    for (int i = 0; i < 100; ++i) {
        script_.push_back([]() -> Instruction { throw away(); });
    }
    EXPECT_THROW(run(seconds(60)), Error);
    EXPECT_GE(time_.load(), seconds(60));
    EXPECT_LT(time_.load(), seconds(70));
}

TEST_F(SessionTest, CoordinatorThatDoesNotWantThisWorkerEndsTheSession) {
    script_ = {[]() -> Instruction { throw Error(Errc::FailedPrecondition, "other build"); }};
    try {
        run();
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), Errc::FailedPrecondition);
    }
}

TEST_F(SessionTest, LostLeaseAbandonsTheRender) {
    script_ = {[] { return begin(kFirst); }, [] { return begin(kSecond); }};
    heartbeat_ = [] { return Instruction{Instruction::Stop{kFirst}, {}}; };
    task_ = [this](const LeaseRef& lease, const std::function<bool()>& abandon) -> TaskOutcome {
        if (lease == kSecond) return finish(lease);
        while (!abandon()) std::this_thread::yield();
        return TaskAbandoned{};
    };
    run();
    EXPECT_THAT(said_, testing::ElementsAre("idle", "released 1", "idle"));
    EXPECT_EQ(uploads_.size(), 2U);
}

TEST_F(SessionTest, RenderGoesOnWhileTheCoordinatorIsAway) {
    script_ = {[] { return begin(kFirst); }};
    heartbeat_ = []() -> Instruction { throw away(); };
    task_ = [this](const LeaseRef& lease, const std::function<bool()>& abandon) {
        while (n_heartbeats_ < 5) std::this_thread::yield();
        EXPECT_FALSE(abandon());
        return finish(lease);
    };
    run();
    EXPECT_EQ(uploads_.size(), 2U);
}

TEST_F(SessionTest, StaleResultIsDropped) {
    script_ = {[] { return begin(kFirst); }};
    commits_ = {[] { return CommitOutcome::Stale; }};
    run();
    EXPECT_THAT(said_, testing::ElementsAre("idle", "idle"));
    EXPECT_TRUE(scratch_is_empty());
}

TEST_F(SessionTest, ResultOfALostLeaseIsDroppedBeforeItIsSentWhole) {
    script_ = {[] { return begin(kFirst); }};
    upload_ = [] { throw Error(Errc::FailedPrecondition, "the lease is lost"); };
    run();
    EXPECT_THAT(said_, testing::ElementsAre("idle", "idle"));
    EXPECT_EQ(uploads_.size(), 1U);
    EXPECT_TRUE(scratch_is_empty());
}

TEST_F(SessionTest, FailureIsReportedUntilItIsHeard) {
    script_ = {[] { return begin(kFirst); }, []() -> Instruction { throw away(); }};
    task_ = [](const LeaseRef&, const std::function<bool()>&) { return TaskFailed{"no scene"}; };
    run();
    EXPECT_THAT(said_, testing::ElementsAre("idle", "failed 1: no scene", "failed 1: no scene"));
}

TEST_F(SessionTest, DamagedDeliveryIsMadeAgainAFewTimes) {
    script_ = {[] { return begin(kFirst); }, [] { return begin(kSecond); }};
    const Commit damaged = []() -> CommitOutcome { throw Error(Errc::DataLoss, "damaged"); };
    commits_ = {damaged, damaged, [] { return CommitOutcome::Accepted; },
                damaged, damaged, damaged};
    run();
    EXPECT_THAT(said_, testing::ElementsAre("idle", "idle", "failed 2: damaged"));
    EXPECT_EQ(uploads_.size(), 12U);
}

TEST_F(SessionTest, WorkerThatIsAskedToStopGivesItsTaskBack) {
    script_ = {[] { return begin(kFirst); }};
    task_ = [this](const LeaseRef&, const std::function<bool()>& abandon) -> TaskOutcome {
        EXPECT_FALSE(abandon());
        stop_.request_stop();
        EXPECT_TRUE(abandon());
        return TaskAbandoned{};
    };
    run();
    EXPECT_THAT(said_, testing::ElementsAre("idle", "released 1 leaving"));
}

TEST_F(SessionTest, WorkerThatIsAskedToStopStillDeliversWhatIsFinished) {
    script_ = {[] { return begin(kFirst); }};
    task_ = [this](const LeaseRef& lease, const std::function<bool()>&) {
        stop_.request_stop();
        return finish(lease);
    };
    run();
    EXPECT_EQ(artefacts_.size(), 2U);
    EXPECT_THAT(said_, testing::ElementsAre("idle", "idle leaving"));
}

TEST_F(SessionTest, WorkerThatIsAskedToStopDoesNotWaitForACoordinator) {
    const Step nobody = []() -> Instruction { throw away(); };
    script_ = {[] { return begin(kFirst); }, nobody, nobody};
    upload_ = [] { throw away(); };
    task_ = [this](const LeaseRef& lease, const std::function<bool()>&) {
        stop_.request_stop();
        return finish(lease);
    };
    run();
    EXPECT_THAT(said_, testing::ElementsAre("idle", "released 1 leaving"));
}

}  // namespace
}  // namespace misbench
