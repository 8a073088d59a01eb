// The estimate of the time that a run still takes, and what a task is taken to cost.
#include "experiments/cli/progress.h"

#include <gtest/gtest.h>

#include "tests/support/made_up_store.h"

namespace misbench {
namespace {

using std::chrono::milliseconds;

QueueStatus::Running at_work(const std::string& task, milliseconds since) {
    return {.worker = "w", .scene = "s", .method = "m", .task = task, .seed = 1, .since = since};
}

TEST(RemainingTime, StartsFromTheCostsSharedAmongTheWorkers) {
    RemainingTime remaining({{"a", {10, false}}, {"b", {20, true}}}, 3);
    EXPECT_DOUBLE_EQ(remaining.estimate({}), 10);
}

TEST(RemainingTime, CountsOffWhatIsDoneAndWhatIsBegun) {
    RemainingTime remaining({{"a", {10, false}}, {"b", {20, false}}, {"c", {30, false}}}, 1);
    QueueStatus status;
    status.running = {at_work("a", milliseconds(4000))};
    EXPECT_DOUBLE_EQ(remaining.estimate(status), 56);
    status.running = {at_work("a", milliseconds(10'000))};
    remaining.estimate(status);
    status.finished = {"a"};
    status.running = {at_work("b", milliseconds(0))};
    EXPECT_DOUBLE_EQ(remaining.estimate(status), 50);
    // Never below zero, however late a task is.
    status.finished = {"a", "b"};
    status.running = {at_work("c", milliseconds(99'000))};
    EXPECT_GE(remaining.estimate(status), 0);
}

TEST(RemainingTime, LearnsFromGuessesAndMeasuredCostsApart) {
    RemainingTime remaining({{"guess1", {10, true}},
                             {"guess2", {10, true}},
                             {"known1", {10, false}},
                             {"known2", {10, false}}},
                            1);
    QueueStatus status;
    status.running = {at_work("guess1", milliseconds(1000)),
                      at_work("known1", milliseconds(15'000))};
    remaining.estimate(status);
    status.running = {};
    status.finished = {"guess1", "known1"};
    EXPECT_DOUBLE_EQ(remaining.estimate(status), 1 + 15);
}

TEST(RemainingTime, DoesNotMindTasksItWasNotToldOf) {
    RemainingTime remaining({{"a", {10, false}}}, 1);
    QueueStatus status;
    status.running = {at_work("other", milliseconds(1000))};
    status.finished = {"another"};
    EXPECT_DOUBLE_EQ(remaining.estimate(status), 10);
}

TEST(CostModel, KnowsTimeBudgetsAndGuessesSamples) {
    CostModel model(nullptr);
    const Cost timed = model.estimate(made_up_task("plain", 1, TimeBudget{2}));
    EXPECT_DOUBLE_EQ(timed.seconds, 2);
    EXPECT_FALSE(timed.is_guess);
    const Cost guessed = model.estimate(made_up_task("plain", 1, SampleBudget{100}));
    EXPECT_DOUBLE_EQ(guessed.seconds, 8 * 4 * 100 * kGuessedSecondsPerSample);
    EXPECT_TRUE(guessed.is_guess);
}

TEST(CostModel, TakesWhatTheStoreHasSeenOfSceneAndMethod) {
    const TemporaryFolder folder;
    Store store(folder.path() / "store", Store::Access::ReadWrite);
    const Task seen = made_up_task("plain", 1, SampleBudget{16});
    store.put_experiment(made_up_plan("made-up", 1));
    commit_made_up_run(store, seen);  // 16 passes in 2.75 s of CPU
    CostModel model(&store);
    const Cost cost = model.estimate(made_up_task("plain", 7, SampleBudget{32}));
    EXPECT_DOUBLE_EQ(cost.seconds, 5.5);
    EXPECT_FALSE(cost.is_guess);
    EXPECT_TRUE(model.estimate(made_up_task("clever", 7, SampleBudget{32})).is_guess);
}

TEST(ProgressMode, IsTakenFromTheOption) {
    EXPECT_EQ(progress_mode("always"), ProgressMode::Line);
    EXPECT_EQ(progress_mode("never"), ProgressMode::Never);
}

}  // namespace
}  // namespace misbench
