// What somebody says of the methods of an experiment, such as a paper: a statement about the ratio
// of two methods' errors that runs can bear out or not. Stored with the plan;
// experiments/analysis/findings.h says what the runs make of it.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "renderer/base/budget.h"

namespace misbench {

// What the ratio is taken over.
enum class ClaimOver {
    Each,   // every scene by itself: one line for each
    Mean,   // the geometric mean of the scenes' ratios
    Worst,  // the largest ratio of all scenes, as in "never worse"
    Best,   // the smallest
};
// "each", "mean", "worst", "best". From text they throw InvalidArgument.
std::string to_string(ClaimOver over);
ClaimOver claim_over_from_string(const std::string& text);

// What the ratio is said to be. A margin m is what counts as noticeable: a ratio between 1/(1 + m)
// and 1 + m does not.
enum class Expectation {
    Less,     // below 1
    More,     // above 1
    NotMore,  // at most 1 + m
    NotLess,  // at least 1/(1 + m)
    Equal,    // between the two
};
// "less", "more", "not_more", "not_less", "equal".
std::string to_string(Expectation expectation);
Expectation expectation_from_string(const std::string& text);

inline constexpr double kDefaultMargin = 0.05;

struct Claim {
    std::string text;
    std::string where;                // in the paper
    std::vector<std::string> scenes;  // names
    std::string method;               // labels: the ratio is error(method)/error(against)
    std::string against;
    std::string metric;  // an id, or kSecondsPerPass
    Budget budget;
    ClaimOver over = ClaimOver::Each;
    Expectation expect = Expectation::Less;
    double margin = kDefaultMargin;
    // The paper's ratio by scene where it is over each, under "" otherwise; empty where none is
    // known.
    std::map<std::string, double> paper = {};
    std::string note;
    bool operator==(const Claim&) const = default;
};

// CPU seconds a pass, which claims can be about as about a metric.
inline constexpr const char* kSecondsPerPass = "seconds_per_pass";

nlohmann::json claim_to_json(const Claim& claim);
Claim claim_from_json(const nlohmann::json& json);

}  // namespace misbench
