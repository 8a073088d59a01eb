#include "results/record.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "renderer/base/error.h"
#include "tests/support/made_up_store.h"

namespace misbench {
namespace {

Record whole_record() {
    Record record = made_up_record(made_up_task("plain", 1, TimeBudget{0.1, BudgetClock::Wall}));
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
        EXPECT_NE(message.find("'" + key + "'"), std::string::npos) << message;
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
    EXPECT_EQ(message, "read a run's record: its format is 3, this program reads 2");
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
