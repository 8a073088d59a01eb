#include "experiments/plan/claim_entry.h"

#include "experiments/plan/budget_entry.h"
#include "renderer/base/error.h"

namespace misbench {
namespace {

// The value that `parse` makes of a word, or its complaint with the place.
auto read_choice(const YamlNode& node, auto parse) {
    try {
        return parse(read_text(node, node.key));
    } catch (const ParameterError& e) {
        fail_at(node.place, e.what());
    }
}

double read_ratio(const YamlNode& node) {
    const double ratio = read_number(node, "the paper's ratio");
    if (ratio <= 0) fail_at(node.place, "the paper's ratio must be above 0: found " + node.text);
    return ratio;
}

std::vector<PaperEntry> read_paper(const YamlNode& node, ClaimOver over) {
    if (node.kind != YamlNode::Kind::Map) return {{{"", node.place}, read_ratio(node)}};
    if (over != ClaimOver::Each) {
        fail_at(node.place, "a claim over '" + to_string(over) +
                                "' has one number; known: numbers by scene only over 'each'");
    }
    std::vector<PaperEntry> numbers;
    for (const YamlNode& item : node.items) {
        numbers.push_back({{item.key, item.key_place}, read_ratio(item)});
    }
    return numbers;
}

double read_margin(const YamlNode& node) {
    const double margin = read_number(node, "margin");
    if (margin <= 0 || margin > kMaxMargin) {
        fail_at(node.place, "margin must be above 0 and at most 1: found " + node.text);
    }
    return margin;
}

ClaimEntry read_claim(const YamlNode& node) {
    const std::string what = "a claim";
    require_keys(node, what,
                 {"claim", "where", "scenes", "method", "against", "metric", "budget", "over",
                  "expect", "margin", "paper", "note"});
    ClaimEntry entry;
    entry.place = node.place;
    entry.text = read_text(require_value(node, what, "claim"), "claim");
    if (const YamlNode* where = node.find("where")) entry.where = read_text(*where, "where");
    if (const YamlNode* scenes = node.find("scenes")) {
        for (const YamlNode& scene : read_one_or_more(*scenes, "scenes")) {
            entry.scenes.push_back(read_placed_text(scene, "a scene"));
        }
    }
    entry.method = read_placed_text(require_value(node, what, "method"), "method");
    if (const YamlNode* against = node.find("against")) {
        entry.against = read_placed_text(*against, "against");
    }
    if (const YamlNode* metric = node.find("metric")) {
        entry.metric = read_placed_text(*metric, "metric");
    }
    if (const YamlNode* budget = node.find("budget")) entry.budget = read_budget(*budget);
    if (const YamlNode* over = node.find("over")) {
        entry.over = read_choice(*over, claim_over_from_string);
    }
    entry.expect = read_choice(require_value(node, what, "expect"), expectation_from_string);
    if (const YamlNode* margin = node.find("margin")) entry.margin = read_margin(*margin);
    if (const YamlNode* paper = node.find("paper")) entry.paper = read_paper(*paper, entry.over);
    if (const YamlNode* note = node.find("note")) entry.note = read_text(*note, "note");
    return entry;
}

}  // namespace

std::vector<ClaimEntry> read_claims(const YamlNode* node) {
    std::vector<ClaimEntry> claims;
    if (node == nullptr) return claims;
    for (const YamlNode& item : read_one_or_more(*node, "claims")) {
        claims.push_back(read_claim(item));
    }
    return claims;
}

}  // namespace misbench
