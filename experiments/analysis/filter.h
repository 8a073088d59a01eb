// Which seeds of which cells a table is about, as people write it:
//
//     scene~veach and (budget=30s or not method=path) and value<0.1
//
//     expression = term { "or" term }
//     term       = factor { "and" factor }
//     factor     = "not" factor | "(" expression ")" | FIELD operator WORD
//     operator   = "=" | "!=" | "~" | "<" | "<=" | ">" | ">="
//
// A word is what stands up to the next space or parenthesis, or between quotes ("..." or '...').
// ~ asks whether the field contains the word, or matches it as a whole where it has * or ?; upper
// and lower case are the same to it. Numbers are compared as numbers. A budget is compared by its
// text without spaces, with or without its clock: 30s, "30 s cpu", 16spp. A seed that has no such
// field, such as a parameter of another method, only matches !=.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "renderer/base/parameters.h"

namespace misbench {

class Filter {
 public:
    using Fields = std::function<std::optional<ParameterValue>(const std::string& field)>;
    struct Node;

    // Throws InvalidArgument with the column and what is known there.
    Filter(std::string_view text, const std::set<std::string>& known_fields);
    bool matches(const Fields& fields) const;

 private:
    std::shared_ptr<const Node> root_;
};

}  // namespace misbench
