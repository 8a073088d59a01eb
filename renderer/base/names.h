// Tables whose rows have a name, and the one way to look a name up.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "renderer/base/error.h"

namespace misbench {

// " a b c": the names of a table's rows, as they end an error message.
template <class Rows>
std::string known_names(const Rows& rows) {
    std::string known;
    for (const auto& row : rows) {
        known += ' ';
        known += row.name;
    }
    return known;
}

// The parts of "a+b+c".
inline std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(separator, begin), text.size());
        parts.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return parts;
}

// The row of that name. Throws ParameterError(key, "unknown <what> '<name>'; known: …").
template <class Rows>
const auto& find_named(const Rows& rows, const std::string& name, const std::string& key,
                       const std::string& what) {
    for (const auto& row : rows) {
        if (row.name == name) return row;
    }
    throw ParameterError(key, "unknown " + what + " '" + name + "'; known:" + known_names(rows));
}

}  // namespace misbench
