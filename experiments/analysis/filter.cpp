#include "experiments/analysis/filter.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <compare>
#include <utility>
#include <vector>

#include "renderer/base/error.h"

namespace misbench {

struct Filter::Node {
    enum class Kind { And, Or, Not, Test };
    Kind kind = Kind::Test;
    std::vector<Node> children = {};
    std::string field = {};
    std::string op = {};
    std::string word = {};
};

namespace {

using Node = Filter::Node;

// Longer ones first: "<=" is not "<".
constexpr std::array<std::string_view, 7> kOperators{"!=", "<=", ">=", "=", "~", "<", ">"};
constexpr std::string_view kBudgetField = "budget";
constexpr int kDeepest = 100;

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n'; }

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

std::string lower(std::string text) {
    std::ranges::transform(text, text.begin(), [](char c) { return lower(c); });
    return text;
}

std::optional<double> number_of(std::string_view text) {
    double number = 0;
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, number);
    if (error != std::errc{} || stop != end) return std::nullopt;
    return number;
}

// With * for any text and ? for one character. Takes back the last * only, which is enough.
bool matches_pattern(std::string_view text, std::string_view pattern) {
    std::size_t t = 0;
    std::size_t p = 0;
    std::optional<std::pair<std::size_t, std::size_t>> star;  // pattern behind it, text it ends at
    while (t < text.size()) {
        if (p < pattern.size() && pattern[p] == '*') {
            star = {++p, t};
        } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == text[t])) {
            ++p;
            ++t;
        } else if (star) {
            p = star->first;
            t = ++star->second;
        } else {
            return false;
        }
    }
    return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

bool contains_or_matches(const std::string& text, const std::string& word) {
    const std::string a = lower(text);
    const std::string b = lower(word);
    if (b.find_first_of("*?") == std::string::npos) return a.find(b) != std::string::npos;
    return matches_pattern(a, b);
}

std::string without_spaces(std::string text) {
    std::erase(text, ' ');
    return lower(std::move(text));
}

bool is_budget(const std::string& text, const std::string& word) {
    const std::string budget = without_spaces(text);
    const std::string wanted = without_spaces(word);
    return budget == wanted || budget == wanted + "cpu" || budget == wanted + "wall";
}

std::partial_ordering order(const std::string& text, const std::string& word) {
    const auto a = number_of(text);
    const auto b = number_of(word);
    if (a && b) return *a <=> *b;
    return text <=> word;
}

bool test(const Node& node, const std::optional<ParameterValue>& value) {
    if (!value) return node.op == "!=";
    const std::string text = to_string(*value);
    if (node.op == "~") return contains_or_matches(text, node.word);
    if (node.field == kBudgetField) return is_budget(text, node.word) == (node.op == "=");
    const std::partial_ordering o = order(text, node.word);
    if (node.op == "=") return o == 0;
    if (node.op == "!=") return o != 0;
    if (node.op == "<") return o < 0;
    if (node.op == "<=") return o <= 0;
    return node.op == ">" ? o > 0 : o >= 0;
}

bool holds(const Node& node, const Filter::Fields& fields) {
    const auto child_holds = [&fields](const Node& child) { return holds(child, fields); };
    switch (node.kind) {
        case Node::Kind::And:
            return std::ranges::all_of(node.children, child_holds);
        case Node::Kind::Or:
            return std::ranges::any_of(node.children, child_holds);
        case Node::Kind::Not:
            return !child_holds(node.children.front());
        case Node::Kind::Test:
            break;
    }
    return test(node, fields(node.field));
}

class Parser {
 public:
    Parser(std::string_view text, const std::set<std::string>& fields)
        : text_(text), fields_(fields) {}

    Node parse() {
        Node node = expression(0);
        skip_spaces();
        if (at_ < text_.size()) fail("expected 'and', 'or' or the end");
        return node;
    }

 private:
    [[noreturn]] void fail(const std::string& what) const {
        const std::string found =
            at_ < text_.size() ? "'" + std::string(text_.substr(at_, 20)) + "'" : "the end";
        throw Error(Errc::InvalidArgument,
                    "filter, column " + std::to_string(at_ + 1) + ": " + what + ", found " + found);
    }

    void skip_spaces() {
        while (at_ < text_.size() && is_space(text_[at_])) ++at_;
    }

    // Takes a word of the grammar, which ends where a name would.
    bool take_keyword(std::string_view keyword) {
        skip_spaces();
        const std::string_view rest = text_.substr(at_);
        if (lower(std::string(rest.substr(0, keyword.size()))) != keyword) return false;
        if (rest.size() > keyword.size() && !is_space(rest[keyword.size()]) &&
            rest[keyword.size()] != '(' && rest[keyword.size()] != ')') {
            return false;
        }
        at_ += keyword.size();
        return true;
    }

    bool take(char c) {
        skip_spaces();
        if (at_ == text_.size() || text_[at_] != c) return false;
        ++at_;
        return true;
    }

    Node expression(int depth) {
        if (depth > kDeepest) fail("expected fewer parentheses");
        Node node{.kind = Node::Kind::Or, .children = {term(depth)}};
        while (take_keyword("or")) node.children.push_back(term(depth));
        return node;
    }

    Node term(int depth) {
        Node node{.kind = Node::Kind::And, .children = {factor(depth)}};
        while (take_keyword("and")) node.children.push_back(factor(depth));
        return node;
    }

    Node factor(int depth) {
        if (depth > kDeepest) fail("expected fewer parentheses");
        if (take_keyword("not")) {
            return {.kind = Node::Kind::Not, .children = {factor(depth + 1)}};
        }
        if (take('(')) {
            Node node = expression(depth + 1);
            if (!take(')')) fail("expected ')'");
            return node;
        }
        Node node{.kind = Node::Kind::Test};
        node.field = field();
        node.op = comparison();
        if (node.field == kBudgetField && node.op != "=" && node.op != "!=" && node.op != "~") {
            fail("expected = != or ~ before a budget, which has no order");
        }
        node.word = word();
        return node;
    }

    std::string field() {
        skip_spaces();
        const std::size_t end = std::min(text_.find_first_of("=!~<> \t\n()\"'", at_), text_.size());
        const std::string name(text_.substr(at_, end - at_));
        if (!fields_.contains(name)) {
            std::string known;
            for (const std::string& f : fields_) known += " " + f;
            fail("expected a field; known:" + known);
        }
        at_ = end;
        return name;
    }

    std::string comparison() {
        skip_spaces();
        for (const std::string_view op : kOperators) {
            if (!text_.substr(at_).starts_with(op)) continue;
            at_ += op.size();
            return std::string(op);
        }
        fail("expected one of = != ~ < <= > >=");
    }

    std::string word() {
        skip_spaces();
        if (at_ < text_.size() && (text_[at_] == '"' || text_[at_] == '\'')) {
            const std::size_t end = text_.find(text_[at_], at_ + 1);
            if (end == std::string_view::npos) fail("expected the end of a quotation");
            const std::string quoted(text_.substr(at_ + 1, end - at_ - 1));
            at_ = end + 1;
            return quoted;
        }
        const std::size_t end = std::min(text_.find_first_of(" \t\n()", at_), text_.size());
        if (end == at_) fail("expected a value");
        const std::string word(text_.substr(at_, end - at_));
        at_ = end;
        return word;
    }

    std::string_view text_;
    const std::set<std::string>& fields_;
    std::size_t at_ = 0;
};

}  // namespace

Filter::Filter(std::string_view text, const std::set<std::string>& known_fields)
    : root_(std::make_shared<const Node>(Parser(text, known_fields).parse())) {}

bool Filter::matches(const Fields& fields) const { return holds(*root_, fields); }

}  // namespace misbench
