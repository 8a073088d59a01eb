#include "experiments/plan/yaml_reader.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "experiments/plan/suggestion.h"
#include "renderer/base/error.h"
#include "renderer/base/files.h"

namespace misbench {
namespace {

Place place_of(const YAML::Mark& mark, const Place& source) {
    if (source.line == 0 || mark.is_null()) return {source.source, 0, 0};
    return {source.source, mark.line + 1, mark.column + 1};
}

// Copies yaml-cpp's graph into our tree, where aliases are expanded and every key is checked.
class TreeBuilder {
 public:
    explicit TreeBuilder(Place source) : source_(std::move(source)) {}

    YamlNode build(const YAML::Node& from, int depth = 0) {
        YamlNode node;
        node.place = place_of(from.Mark(), source_);
        if (depth > kMaxYamlDepth) {
            fail_at(node.place, "nested deeper than " + std::to_string(kMaxYamlDepth) + " levels");
        }
        if (++n_nodes_ > kMaxYamlNodes) {
            fail_at(node.place, "more than " + std::to_string(kMaxYamlNodes) + " values");
        }
        if (from.IsScalar()) {
            node.kind = YamlNode::Kind::Scalar;
            node.text = from.Scalar();
            node.quoted = from.Tag() != "?" && !from.Tag().empty();
        } else if (from.IsSequence()) {
            node.kind = YamlNode::Kind::Sequence;
            for (const YAML::Node& item : from) node.items.push_back(build(item, depth + 1));
        } else if (from.IsMap()) {
            build_map(from, depth, node);
        }
        return node;
    }

 private:
    void build_map(const YAML::Node& from, int depth, YamlNode& node) {
        node.kind = YamlNode::Kind::Map;
        for (const auto& entry : from) {
            const Place key_place = place_of(entry.first.Mark(), source_);
            if (!entry.first.IsScalar()) fail_at(key_place, "a key must be a plain word");
            const std::string& key = entry.first.Scalar();
            if (const YamlNode* first = node.find(key)) {
                fail_at(key_place, "key '" + key + "' is written twice, first at line " +
                                       std::to_string(first->key_place.line));
            }
            YamlNode value = build(entry.second, depth + 1);
            if (value.kind == YamlNode::Kind::Null) value.place = key_place;
            value.key = key;
            value.key_place = key_place;
            node.items.push_back(std::move(value));
        }
    }

    Place source_;
    int n_nodes_ = 0;
};

// What was found, for a message that says what was wanted.
std::string found(const YamlNode& node) {
    switch (node.kind) {
        case YamlNode::Kind::Null:
            return "nothing";
        case YamlNode::Kind::Sequence:
            return "a list";
        case YamlNode::Kind::Map:
            return "a map";
        case YamlNode::Kind::Scalar:
            break;
    }
    return "'" + node.text + "'";
}

// An optional sign, then digits without a leading zero.
bool is_decimal(std::string_view text) {
    if (text.starts_with('-') || text.starts_with('+')) text.remove_prefix(1);
    const bool digits =
        !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
    return digits && (text.size() == 1 || text.front() != '0');
}

template <typename Number>
bool parse_whole(std::string_view text, Number& value) {
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc{} && end == text.data() + text.size();
}

// Digits first, so that "inf" and "nan" are words.
bool is_number(std::string_view text, double& value) {
    const auto first = text.find_first_not_of("+-");
    if (first > 1 || first == std::string_view::npos) return false;
    if (text[first] != '.' && (text[first] < '0' || text[first] > '9')) return false;
    return parse_whole(text, value) && std::isfinite(value);
}

bool is_plain_scalar(const YamlNode& node) {
    return node.kind == YamlNode::Kind::Scalar && !node.quoted;
}

}  // namespace

std::string to_string(const Place& place) {
    if (place.line == 0) return place.source;
    return place.source + ":" + std::to_string(place.line) + ":" + std::to_string(place.column);
}

void fail_at(const Place& place, const std::string& message) {
    throw Error(Errc::InvalidArgument, to_string(place) + ": " + message);
}

const YamlNode* YamlNode::find(std::string_view name) const {
    if (kind != Kind::Map) return nullptr;
    const auto it = std::ranges::find(items, name, &YamlNode::key);
    return it == items.end() ? nullptr : &*it;
}

YamlNode* YamlNode::find(std::string_view name) {
    return const_cast<YamlNode*>(std::as_const(*this).find(name));
}

YamlNode read_yaml_file(const std::filesystem::path& file) {
    return parse_yaml(read_file(file), file.string());
}

YamlNode parse_yaml(const std::string& text, const std::string& source, bool lines) {
    const Place place{source, lines ? 1 : 0, lines ? 1 : 0};
    try {
        const std::vector<YAML::Node> documents = YAML::LoadAll(text);
        if (documents.empty()) fail_at(place, "the file is empty");
        if (documents.size() > 1) {
            fail_at(place_of(documents[1].Mark(), place), "a second document; known: one per file");
        }
        return TreeBuilder(place).build(documents.front());
    } catch (const YAML::Exception& e) {
        fail_at(place_of(e.mark, place), e.msg);
    }
}

bool read_bool(const YamlNode& node, const std::string& what) {
    if (is_plain_scalar(node) && (node.text == "true" || node.text == "false")) {
        return node.text == "true";
    }
    fail_at(node.place, what + " must be true or false: found " + found(node));
}

std::int64_t read_integer(const YamlNode& node, const std::string& what, std::int64_t minimum,
                          std::int64_t maximum) {
    std::int64_t value = 0;
    if (is_plain_scalar(node) && is_decimal(node.text) && parse_whole(node.text, value) &&
        value >= minimum && value <= maximum) {
        return value;
    }
    fail_at(node.place, what + " must be a decimal integer from " + std::to_string(minimum) +
                            " to " + std::to_string(maximum) + ": found " + found(node));
}

double read_number(const YamlNode& node, const std::string& what) {
    double value = 0;
    if (is_plain_scalar(node) && is_number(node.text, value)) return value;
    fail_at(node.place, what + " must be a number: found " + found(node));
}

std::string read_text(const YamlNode& node, const std::string& what) {
    if (node.kind == YamlNode::Kind::Scalar) return node.text;
    fail_at(node.place, what + " must be text: found " + found(node));
}

Placed<std::string> read_placed_text(const YamlNode& node, const std::string& what) {
    return {read_text(node, what), node.place};
}

std::string read_word(const YamlNode& node, const std::string& what) {
    const std::string word = read_text(node, what);
    const bool ok = !word.empty() && word.size() <= 100 && word.front() != '.' &&
                    std::ranges::all_of(word, [](char c) {
                        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                               (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '.';
                    });
    if (!ok) {
        fail_at(node.place, what +
                                " must be 1 to 100 letters, digits, '-', '_' or '.', not first: "
                                "found '" +
                                word + "'");
    }
    return word;
}

ParameterValue read_parameter(const YamlNode& node, const std::string& what) {
    if (node.kind != YamlNode::Kind::Scalar) {
        fail_at(node.place, what + " must be a single value: found " + found(node));
    }
    if (node.quoted) return node.text;
    if (node.text == "true" || node.text == "false") return node.text == "true";
    std::int64_t integer = 0;
    if (is_decimal(node.text) && parse_whole(node.text, integer)) return integer;
    double number = 0;
    if (!is_number(node.text, number)) return node.text;
    if (node.text.find_first_of(".eE") == std::string::npos) {
        fail_at(node.place, what + ": '" + node.text + "' is not a decimal integer that fits");
    }
    return number;
}

std::vector<YamlNode> read_one_or_more(const YamlNode& node, const std::string& what) {
    if (node.kind != YamlNode::Kind::Sequence) return {node};
    if (node.items.empty()) fail_at(node.place, what + " must not be empty");
    return node.items;
}

void require_map(const YamlNode& node, const std::string& what) {
    if (node.kind != YamlNode::Kind::Map) {
        fail_at(node.place, what + " must be a map: found " + found(node));
    }
}

void require_keys(const YamlNode& node, const std::string& what,
                  const std::vector<std::string>& known) {
    require_map(node, what);
    for (const YamlNode& item : node.items) {
        if (std::ranges::find(known, item.key) == known.end()) {
            fail_at(item.key_place, unknown_name("key", item.key, known));
        }
    }
}

const YamlNode& require_value(const YamlNode& node, const std::string& what,
                              const std::string& key) {
    const YamlNode* value = node.find(key);
    if (value == nullptr) fail_at(node.place, what + " lacks '" + key + "'");
    return *value;
}

}  // namespace misbench
