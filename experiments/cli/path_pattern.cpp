#include "experiments/cli/path_pattern.h"

#include <algorithm>

#include "experiments/plan/suggestion.h"
#include "renderer/base/error.h"

namespace misbench {
namespace {

constexpr const char* kSceneField = "scene";

std::string to_text(const Fields& fields) {
    std::string text;
    for (const auto& [name, value] : fields) {
        text += (text.empty() ? "" : " ") + name + "='" + value + "'";
    }
    return text;
}

}  // namespace

PathPattern::PathPattern(const std::string& pattern, const std::vector<std::string>& known)
    : pattern_(pattern) {
    const auto fail = [&pattern](const std::string& what) {
        throw Error(Errc::InvalidArgument, "--pattern '" + pattern + "': " + what);
    };
    std::vector<std::string> seen;
    for (std::size_t at = 0; at < pattern.size(); ++at) {
        const char c = pattern[at];
        if (c == '*') {
            parts_.push_back({Part::Kind::Any, ""});
        } else if (c == '{') {
            const std::size_t end = pattern.find('}', at);
            if (end == std::string::npos) fail("a '{' without its '}'");
            const std::string name = pattern.substr(at + 1, end - at - 1);
            if (std::ranges::find(known, name) == known.end()) {
                fail(unknown_name("field", name, known));
            }
            if (std::ranges::find(seen, name) != seen.end()) fail("{" + name + "} twice");
            seen.push_back(name);
            parts_.push_back({Part::Kind::Field, name});
            at = end;
        } else {
            if (parts_.empty() || parts_.back().kind != Part::Kind::Text) {
                parts_.push_back({Part::Kind::Text, ""});
            }
            parts_.back().text += c;
        }
    }
}

std::optional<Fields> PathPattern::match(const std::string& path) const {
    Fields fields;
    std::vector<Fields> found;
    match_from(0, path, 0, fields, found);
    std::ranges::sort(found);
    found.erase(std::unique(found.begin(), found.end()), found.end());
    if (found.empty()) return std::nullopt;
    if (found.size() > 1) {
        throw Error(Errc::InvalidArgument, "--pattern '" + pattern_ + "': it fits '" + path +
                                               "' in two ways: " + to_text(found[0]) + ", or " +
                                               to_text(found[1]));
    }
    return found.front();
}

// Tries every end of a field: paths are short.
void PathPattern::match_from(std::size_t part, const std::string& path, std::size_t at,
                             Fields& fields, std::vector<Fields>& found) const {
    if (part == parts_.size()) {
        if (at == path.size()) found.push_back(fields);
        return;
    }
    const auto& [kind, text] = parts_[part];
    if (kind == Part::Kind::Text) {
        if (path.compare(at, text.size(), text) == 0) {
            match_from(part + 1, path, at + text.size(), fields, found);
        }
        return;
    }
    const bool spans_folders = kind == Part::Kind::Field && text == kSceneField;
    if (kind == Part::Kind::Any) match_from(part + 1, path, at, fields, found);
    const bool is_number = kind == Part::Kind::Field && text != kSceneField && text != "method" &&
                           text != "renderer" && text != "budget";
    for (std::size_t end = at; end < path.size(); ++end) {
        const char c = path[end];
        if (c == '/' && !spans_folders) break;
        if (is_number && !(c >= '0' && c <= '9') && c != '.') break;
        if (kind == Part::Kind::Field) fields[text] = path.substr(at, end + 1 - at);
        match_from(part + 1, path, end + 1, fields, found);
    }
    if (kind == Part::Kind::Field) fields.erase(text);
}

}  // namespace misbench
