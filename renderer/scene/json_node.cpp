#include "renderer/scene/json_node.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "renderer/base/error.h"
#include "renderer/base/files.h"

namespace misbench {
namespace {

using nlohmann::json;

// The index behind the comment that begins at `at`; `at` itself where none begins.
std::size_t skip_comment(std::string_view text, std::size_t at) {
    const std::string_view opening = text.substr(at, 2);
    if (opening != "//" && opening != "/*") return at;
    const std::string_view closing = opening == "//" ? "\n" : "*/";
    const std::size_t end = text.find(closing, at + 2);
    return end == std::string_view::npos ? text.size() : end + closing.size();
}

// The index behind the string that begins at `at`.
std::size_t skip_string(std::string_view text, std::size_t at) {
    for (++at; at < text.size() && text[at] != '"'; ++at) {
        if (text[at] == '\\') ++at;
    }
    return std::min(at + 1, text.size());
}

// Blanks every comma that stands between a value and the end of its array or object, so that lines
// and columns stay the same.
void blank_trailing_commas(std::string& text) {
    constexpr std::size_t kNone = std::string::npos;
    std::size_t comma = kNone;  // the last one, if nothing but space came after it
    char before = '[';          // the last character that is not space
    for (std::size_t at = 0; at < text.size();) {
        const char c = text[at];
        if (const std::size_t end = skip_comment(text, at); end != at) {
            at = end;
            continue;
        }
        if (c == ' ' || c == '\t' || c == '\r' || c == '\n') {
            ++at;
            continue;
        }
        if ((c == ']' || c == '}') && comma != kNone) text[comma] = ' ';
        const bool follows_value = std::string_view("[{,:").find(before) == std::string_view::npos;
        comma = c == ',' && follows_value ? at : kNone;
        before = c;
        at = c == '"' ? skip_string(text, at) : at + 1;
    }
}

// The number as a float, if it is one that a float can hold.
std::optional<float> float_of(const json& value) {
    if (!value.is_number()) return std::nullopt;
    const auto wide = value.get<double>();
    if (std::abs(wide) > double{std::numeric_limits<float>::max()}) return std::nullopt;
    return static_cast<float>(wide);
}

}  // namespace

json parse_json_file(const std::filesystem::path& file) {
    std::string text = read_file(file);
    blank_trailing_commas(text);
    try {
        return json::parse(text, nullptr, true, /*ignore_comments=*/true);
    } catch (const json::exception& e) {
        // The library's message names line and column after its own error number.
        const std::string what = e.what();
        throw Error(Errc::InvalidArgument,
                    "scene '" + file.string() + "': " + what.substr(what.find("] ") + 2));
    }
}

void JsonNode::fail(const std::string& reason) const {
    throw Error(Errc::InvalidArgument,
                "scene '" + file_ + "': " + (place_.empty() ? "" : place_ + ": ") + reason);
}

void JsonNode::fail_expecting(const std::string& what) const {
    // Only plain values are shown: printing a nested one recurses as deep as it goes.
    const std::string found =
        value_->is_structured() ? value_->type_name() : value_->dump().substr(0, 60);
    fail("expected " + what + ", found " + found);
}

bool JsonNode::has(const char* key) const { return value_->is_object() && value_->contains(key); }

bool JsonNode::is_string() const { return value_->is_string(); }

JsonNode JsonNode::operator[](const char* key) const {
    if (!has(key)) fail(std::string("missing '") + key + "'");
    return {&(*value_)[key], file_, place_.empty() ? key : place_ + "." + key};
}

const json& JsonNode::array() const {
    if (!value_->is_array()) fail_expecting("an array");
    return *value_;
}

JsonNode JsonNode::element(std::size_t i) const {
    return {&(*value_)[i], file_, place_ + "[" + std::to_string(i) + "]"};
}

std::vector<JsonNode> JsonNode::list(const char* key) const {
    std::vector<JsonNode> nodes;
    if (!has(key)) return nodes;
    const JsonNode node = (*this)[key];
    for (std::size_t i = 0; i < node.array().size(); ++i) nodes.push_back(node.element(i));
    return nodes;
}

std::string JsonNode::string() const {
    if (!value_->is_string()) fail_expecting("a string");
    return value_->get<std::string>();
}

std::string JsonNode::string_or(const char* key, const std::string& fallback) const {
    return has(key) ? (*this)[key].string() : fallback;
}

bool JsonNode::boolean_or(const char* key, bool fallback) const {
    if (!has(key)) return fallback;
    const JsonNode node = (*this)[key];
    if (!node.value_->is_boolean()) node.fail_expecting("true or false");
    return node.value_->get<bool>();
}

float JsonNode::number() const {
    const std::optional<float> value = float_of(*value_);
    if (!value) fail_expecting("a number of single precision");
    return *value;
}

float JsonNode::number_or(const char* key, float fallback) const {
    return has(key) ? (*this)[key].number() : fallback;
}

float JsonNode::fraction_or(const char* key, float fallback) const {
    const float value = number_or(key, fallback);
    if (value < 0 || value > 1) (*this)[key].fail("is not between 0 and 1");
    return value;
}

std::vector<float> JsonNode::numbers(std::size_t multiple_of) const {
    const json& values = array();
    if (values.size() % multiple_of != 0) {
        fail("expected a multiple of " + std::to_string(multiple_of) + " numbers, found " +
             std::to_string(values.size()));
    }
    std::vector<float> result;
    result.reserve(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::optional<float> value = float_of(values[i]);
        if (!value) element(i).number();  // throws, naming the element
        result.push_back(*value);
    }
    return result;
}

Vec3 JsonNode::vec3() const {
    const std::vector<float> v = numbers(1);
    if (v.size() != 3) fail("expected 3 numbers, found " + std::to_string(v.size()));
    return {v[0], v[1], v[2]};
}

Vec3 JsonNode::vec3_or(const char* key, Vec3 fallback) const {
    return has(key) ? (*this)[key].vec3() : fallback;
}

std::vector<std::uint32_t> JsonNode::indices(std::size_t end) const {
    std::vector<std::uint32_t> result;
    result.reserve(array().size());
    for (const json& value : array()) {
        if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= end) {
            fail("index " + (value.is_structured() ? value.type_name() : value.dump()) +
                 " names none of " + std::to_string(end) + " vertices");
        }
        result.push_back(value.get<std::uint32_t>());
    }
    return result;
}

}  // namespace misbench
