#include "experiments/lab/curve_file.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "experiments/plan/suggestion.h"

namespace misbench::lab {
namespace {

std::vector<double> read_numbers(const YamlNode& node, const std::string& what) {
    std::vector<double> numbers;
    for (const YamlNode& item : read_one_or_more(node, what)) {
        numbers.push_back(read_number(item, what));
    }
    return numbers;
}

double require_number(const YamlNode& map, const std::string& what, const std::string& key) {
    return read_number(require_value(map, what, key), key);
}

double require_at_least(const YamlNode& map, const std::string& what, const std::string& key,
                        double minimum) {
    const YamlNode& node = require_value(map, what, key);
    const double number = read_number(node, key);
    if (!(number >= minimum)) {
        fail_at(node.place, key + " must be at least " + to_string(ParameterValue(minimum)) +
                                ": found " + node.text);
    }
    return number;
}

Table read_table(const YamlNode& node, const std::string& what) {
    Table table{read_numbers(require_value(node, what, "x"), "x"),
                read_numbers(require_value(node, what, "y"), "y")};
    if (table.x.size() < 2 || table.x.size() != table.y.size()) {
        fail_at(node.place, "a table has as many x as y, at least two");
    }
    if (std::ranges::adjacent_find(table.x, std::greater_equal<>()) != table.x.end()) {
        fail_at(node.place, "the x of a table must grow");
    }
    return table;
}

// `keys` are the shape's own; these every shape has.
void require_shape_keys(const YamlNode& node, const std::string& what,
                        std::vector<std::string> keys) {
    keys.insert(keys.end(), {"shape", "weight", "support"});
    require_keys(node, what, keys);
}

Term read_term(const YamlNode& node, const Domain& domain) {
    require_map(node, "a shape");
    const YamlNode& shape = require_value(node, "a shape", "shape");
    const std::string name = read_text(shape, "shape");
    const std::string what = "shape '" + name + "'";
    Term term{.shape = Uniform{domain}, .weight = 1, .support = domain};
    if (name == "uniform") {
        require_shape_keys(node, what, {});
    } else if (name == "linear") {
        require_shape_keys(node, what, {"from", "to"});
        term.shape =
            Linear{domain, require_number(node, what, "from"), require_number(node, what, "to")};
    } else if (name == "gaussian") {
        require_shape_keys(node, what, {"mean", "deviation"});
        constexpr double kLeastDeviation = 1e-6;
        term.shape = Gaussian{require_number(node, what, "mean"),
                              require_at_least(node, what, "deviation", kLeastDeviation)};
    } else if (name == "beta") {
        require_shape_keys(node, what, {"a", "b"});
        term.shape = Beta{domain, require_at_least(node, what, "a", 1),
                          require_at_least(node, what, "b", 1)};
    } else if (name == "table") {
        require_shape_keys(node, what, {"x", "y"});
        term.shape = read_table(node, what);
    } else {
        fail_at(shape.place,
                unknown_name("shape", name, {"uniform", "linear", "gaussian", "beta", "table"}));
    }
    if (const YamlNode* weight = node.find("weight")) term.weight = read_number(*weight, "weight");
    if (const YamlNode* support = node.find("support")) {
        term.support = read_interval(*support, "support");
        if (!domain.contains(term.support.low) || !domain.contains(term.support.high)) {
            fail_at(support->place, "support must be in the domain");
        }
    }
    return term;
}

std::vector<Term> read_terms(const YamlNode& node, const Domain& domain) {
    std::vector<Term> terms;
    for (const YamlNode& item : read_one_or_more(node, "a curve")) {
        terms.push_back(read_term(item, domain));
    }
    return terms;
}

bool may_be_negative(const Term& term) {
    if (term.weight < 0) return true;
    if (const auto* line = std::get_if<Linear>(&term.shape)) return line->from < 0 || line->to < 0;
    const auto* table = std::get_if<Table>(&term.shape);
    return table != nullptr && *std::ranges::min_element(table->y) < 0;
}

}  // namespace

Domain read_interval(const YamlNode& node, const std::string& what) {
    const std::vector<double> ends = read_numbers(node, what);
    if (ends.size() != 2 || !(ends[0] < ends[1])) {
        fail_at(node.place, what + " must be [low, high] with low below high");
    }
    return {ends[0], ends[1]};
}

Curve read_curve(const YamlNode& node, const Domain& domain) {
    return {read_terms(node, domain), domain};
}

Density read_density(const YamlNode& node, const Domain& domain) {
    std::vector<Term> terms = read_terms(node, domain);
    if (std::ranges::any_of(terms, may_be_negative)) {
        fail_at(node.place, "a shape of a density must not be below 0");
    }
    Curve curve(std::move(terms), domain);
    if (!(curve.integral_to(domain.high) > 0)) {
        fail_at(node.place, "a density must be above 0 somewhere in the domain");
    }
    return Density(std::move(curve));
}

}  // namespace misbench::lab
