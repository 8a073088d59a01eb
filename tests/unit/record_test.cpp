#include "results/record.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "renderer/base/error.h"
#include "tests/support/made_up_store.h"

namespace misbench {
namespace {

Record whole_record() {
    Task task = made_up_task("plain", 1, TimeBudget{0.1, BudgetClock::Wall});
    task.snapshots = SnapshotLadder{};
    Record record = made_up_record(task);
    record.snapshots = {made_up_snapshot(task, 1), made_up_snapshot(task, 4)};
    record.valid = false;
    record.image_sha256 = sha256_hex("image");
    record.statistics.nonfinite_samples = 2;
    record.statistics.negative_samples = 3;
    record.statistics.first_bad_sample = SamplePlace{.x = 1, .y = 2, .pass = 3};
    return record;
}

Errc code_of(const nlohmann::json& json, std::string& message) {
    try {
        record_from_json(json);
    } catch (const Error& e) {
        message = e.what();
        return e.code();
    }
    return Errc::Internal;
}

TEST(Record, ComesBackFromJsonAsItWas) {
    for (const bool has_bad_sample : {true, false}) {
        Record record = whole_record();
        if (!has_bad_sample) record.statistics.first_bad_sample.reset();
        const std::string text = record_to_json(record).dump();
        EXPECT_EQ(record_from_json(nlohmann::json::parse(text)), record);
    }
}

// Removes each field in turn, whatever fields there are.
void expect_each_field_is_missed(const nlohmann::json& whole,
                                 const nlohmann::json::json_pointer& at) {
    for (const auto& [key, value] : whole[at].items()) {
        nlohmann::json damaged = whole;
        damaged[at].erase(key);
        std::string message;
        EXPECT_EQ(code_of(damaged, message), Errc::DataLoss) << key;
        EXPECT_NE(message.find(key), std::string::npos) << message;
    }
}

TEST(Record, NamesTheFieldThatIsMissing) {
    const nlohmann::json whole = record_to_json(whole_record());
    for (const char* at : {"", "/statistics", "/statistics/first_bad_sample", "/provenance"}) {
        expect_each_field_is_missed(whole, nlohmann::json::json_pointer(at));
    }
}

TEST(Record, RefusesAFieldOfAnotherType) {
    const nlohmann::json whole = record_to_json(whole_record());
    for (const auto& [key, value] : whole.items()) {
        nlohmann::json damaged = whole;
        damaged[key] = nlohmann::json::array({1});
        std::string message;
        EXPECT_EQ(code_of(damaged, message), Errc::DataLoss) << key;
        EXPECT_NE(message.find("'" + key), std::string::npos) << message;
    }
    nlohmann::json half = whole;
    half["statistics"]["passes"] = 1.5;
    std::string message;
    EXPECT_EQ(code_of(half, message), Errc::DataLoss);
    EXPECT_EQ(message, "read a run's record: 'statistics.passes' is not an integer");
}

TEST(Record, RefusesAnotherFormat) {
    nlohmann::json other = record_to_json(whole_record());
    other["format"] = Record::kFormat + 1;
    std::string message;
    EXPECT_EQ(code_of(other, message), Errc::FailedPrecondition);
    EXPECT_EQ(message, "read a run's record: its format is 4, this program reads 2 and 3");
}

TEST(Record, IsReadFromTheFormatWithoutSnapshots) {
    const Record record = made_up_record(made_up_task("plain", 1, SampleBudget{16}));
    nlohmann::json old = record_to_json(record);
    old.erase("snapshots");
    old["format"] = 2;
    EXPECT_EQ(record_from_json(old), record);
    old["format"] = 3;
    std::string message;
    EXPECT_EQ(code_of(old, message), Errc::DataLoss);
}

TEST(Record, RefusesSnapshotsThatCannotBe) {
    const nlohmann::json whole = record_to_json(whole_record());
    const auto refusal = [&whole](const auto& change) {
        nlohmann::json other = whole;
        change(other);
        std::string message;
        EXPECT_EQ(code_of(other, message), Errc::DataLoss);
        return message;
    };
    EXPECT_EQ(refusal([](auto& o) { o["snapshots"][0]["statistics"]["samples"] = 4; }),
              "read a run's record: 'snapshots' have no growing samples");
    EXPECT_EQ(refusal([](auto& o) { o["snapshots"][1]["statistics"].erase("rays"); }),
              "read a run's record: 'snapshots.1.statistics.rays' is missing");
    EXPECT_EQ(refusal([](auto& o) { o["snapshots"] = {1}; }),
              "read a run's record: 'snapshots.0' is not an object");
    EXPECT_EQ(refusal([](auto& o) { o["snapshots"] = 1; }),
              "read a run's record: 'snapshots' is not a list");
}

TEST(Record, NamesAndKnowsTheFilesOfSnapshots) {
    EXPECT_EQ(snapshot_file(64), "snapshot-000064.exr");
    EXPECT_EQ(snapshot_file(12345678), "snapshot-12345678.exr");
    EXPECT_TRUE(is_snapshot_file("snapshot-000064.exr"));
    EXPECT_TRUE(is_snapshot_file(snapshot_file(std::int64_t{1} << 62)));
    for (const char* name : {"snapshot-64.exr", "snapshot-.exr", "snapshot-00006/.exr", "image.exr",
                             "snapshot-000064.exr.", "snapshot-00000000000000000064.exr"}) {
        EXPECT_FALSE(is_snapshot_file(name)) << name;
    }
}

TEST(Task, KeepsItsIdWhereNoSnapshotsAreAskedFor) {
    Task task = made_up_task("plain", 1, SampleBudget{16});
    EXPECT_EQ(task_id(task), "53f278211e82ae423e1046bce00b5afe");
    EXPECT_EQ(task_from_json(task_to_json(task)), task);
    Task other = task;
    other.snapshots = SnapshotLadder{};
    EXPECT_NE(task_id(other), task_id(task));
    EXPECT_EQ(task_from_json(task_to_json(other)), other);
    task.snapshots = SnapshotLadder{.first = 2, .factor = 2};
    EXPECT_NE(task_id(other), task_id(task));
}

TEST(Record, RefusesATaskThatIsNotTheRuns) {
    nlohmann::json other = record_to_json(whole_record());
    other["task"]["seed"] = 2;
    std::string message;
    EXPECT_EQ(code_of(other, message), Errc::DataLoss);
    EXPECT_EQ(message, "read a run's record: 'run' is not the id of its task");
}

}  // namespace
}  // namespace misbench
