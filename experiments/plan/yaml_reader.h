// YAML as a tree of values that know where they were written, read strictly: a key may occur once,
// integers are decimal, booleans are true and false, and every error says FILE:LINE:COLUMN.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/base/parameters.h"

namespace misbench {

struct Place {
    std::string source;  // a file as the user named it, or "--set path=value"
    int line = 0;        // from 1; 0 where the source has no lines
    int column = 0;      // from 1
};
std::string to_string(const Place& place);

// Throws InvalidArgument "PLACE: message".
[[noreturn]] void fail_at(const Place& place, const std::string& message);

template <typename T>
struct Placed {
    T value{};
    Place place;
};

struct YamlNode {
    enum class Kind { Null, Scalar, Sequence, Map };

    Kind kind = Kind::Null;
    Place place;
    std::string text;             // of a scalar
    bool quoted = false;          // a quoted scalar is text, whatever it looks like
    std::vector<YamlNode> items;  // of a sequence, or the values of a map in their order
    std::string key;              // of a map's value
    Place key_place;

    const YamlNode* find(std::string_view name) const;  // a map's value; null when there is none
    YamlNode* find(std::string_view name);
};

inline constexpr int kMaxYamlDepth = 32;
inline constexpr int kMaxYamlNodes = 100'000;  // aliases expand: a small file can be a huge tree

// Throws NotFound or DataLoss for the file, InvalidArgument for what is in it.
YamlNode read_yaml_file(const std::filesystem::path& file);
// `source` stands for the file in messages. With `lines` false places name the source only.
YamlNode parse_yaml(const std::string& text, const std::string& source, bool lines = true);

// The value of a node, or an error that says what `what` must be.
bool read_bool(const YamlNode& node, const std::string& what);
std::int64_t read_integer(const YamlNode& node, const std::string& what, std::int64_t minimum,
                          std::int64_t maximum);
double read_number(const YamlNode& node, const std::string& what);
std::string read_text(const YamlNode& node, const std::string& what);
Placed<std::string> read_placed_text(const YamlNode& node, const std::string& what);
// A word that can be part of a file's name and a column of a table.
std::string read_word(const YamlNode& node, const std::string& what);
// The type follows from how the value is written: true, 3, 0.5 or 1e3, anything else is text.
ParameterValue read_parameter(const YamlNode& node, const std::string& what);
// The items of a sequence; a single value stands for a sequence of one.
std::vector<YamlNode> read_one_or_more(const YamlNode& node, const std::string& what);

// A node that must be a map with keys among `known`.
void require_map(const YamlNode& node, const std::string& what);
void require_keys(const YamlNode& node, const std::string& what,
                  const std::vector<std::string>& known);
// The value of a key that must be there.
const YamlNode& require_value(const YamlNode& node, const std::string& what,
                              const std::string& key);

}  // namespace misbench
