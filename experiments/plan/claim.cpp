#include "experiments/plan/claim.h"

#include <array>
#include <nlohmann/json.hpp>

#include "renderer/base/names.h"

namespace misbench {
namespace {

template <typename Value>
struct Named {
    Value value;
    const char* name;
};

constexpr std::array kOvers{
    Named<ClaimOver>{ClaimOver::Each, "each"}, Named<ClaimOver>{ClaimOver::Mean, "mean"},
    Named<ClaimOver>{ClaimOver::Worst, "worst"}, Named<ClaimOver>{ClaimOver::Best, "best"}};
constexpr std::array kExpectations{Named<Expectation>{Expectation::Less, "less"},
                                   Named<Expectation>{Expectation::More, "more"},
                                   Named<Expectation>{Expectation::NotMore, "not_more"},
                                   Named<Expectation>{Expectation::NotLess, "not_less"},
                                   Named<Expectation>{Expectation::Equal, "equal"}};

std::string name_in(const auto& rows, auto value) {
    for (const auto& row : rows) {
        if (row.value == value) return row.name;
    }
    throw Error(Errc::Internal, "a value without a name in a claim");
}

}  // namespace

std::string to_string(ClaimOver over) { return name_in(kOvers, over); }

ClaimOver claim_over_from_string(const std::string& text) {
    return find_named(kOvers, text, "over", "value of 'over'").value;
}

std::string to_string(Expectation expectation) { return name_in(kExpectations, expectation); }

Expectation expectation_from_string(const std::string& text) {
    return find_named(kExpectations, text, "expect", "expectation").value;
}

nlohmann::json claim_to_json(const Claim& claim) {
    return {{"claim", claim.text},
            {"where", claim.where},
            {"scenes", claim.scenes},
            {"method", claim.method},
            {"against", claim.against},
            {"metric", claim.metric},
            {"budget", budget_to_json(claim.budget)},
            {"over", to_string(claim.over)},
            {"expect", to_string(claim.expect)},
            {"margin", claim.margin},
            {"paper", claim.paper},
            {"note", claim.note}};
}

Claim claim_from_json(const nlohmann::json& json) {
    return {.text = json.at("claim"),
            .where = json.at("where"),
            .scenes = json.at("scenes"),
            .method = json.at("method"),
            .against = json.at("against"),
            .metric = json.at("metric"),
            .budget = budget_from_json(json.at("budget")),
            .over = claim_over_from_string(json.at("over")),
            .expect = expectation_from_string(json.at("expect")),
            .margin = json.at("margin"),
            .paper = json.at("paper").get<std::map<std::string, double>>(),
            .note = json.at("note")};
}

}  // namespace misbench
