#include "experiments/plan/override.h"

#include <algorithm>
#include <charconv>

#include "experiments/plan/suggestion.h"

namespace misbench {
namespace {

std::vector<std::string> split_path(const std::string& path) {
    std::vector<std::string> keys(1);
    for (const char c : path) {
        if (c == '.') {
            keys.emplace_back();
        } else {
            keys.back() += c;
        }
    }
    return keys;
}

// What an item of a list can be called: its number or, in `scenes`, the scene.
std::string item_name(const YamlNode& item) {
    if (item.kind == YamlNode::Kind::Scalar) return item.text;
    const YamlNode* scene = item.find("scene");
    return scene == nullptr ? "" : scene->text;
}

std::vector<std::string> child_names(const YamlNode& node) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < node.items.size(); ++i) {
        const bool is_map = node.kind == YamlNode::Kind::Map;
        const std::string name = is_map ? node.items[i].key : item_name(node.items[i]);
        names.push_back(name.empty() ? std::to_string(i) : name);
    }
    return names;
}

YamlNode* find_item(YamlNode& list, const std::string& key) {
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), index);
    if (error == std::errc{} && end == key.data() + key.size() && index < list.items.size()) {
        return &list.items[index];
    }
    const auto named = std::ranges::find(list.items, key, item_name);
    return named == list.items.end() ? nullptr : &*named;
}

YamlNode* find_child(YamlNode& node, const std::string& key) {
    return node.kind == YamlNode::Kind::Sequence ? find_item(node, key) : node.find(key);
}

YamlNode& add_child(YamlNode& map, const std::string& key, const Place& place) {
    YamlNode& child = map.items.emplace_back();
    child.place = child.key_place = place;
    child.key = key;
    return child;
}

// A scene that is written as a bare name is made the map that it stands for.
void make_map(YamlNode& node) {
    if (node.kind != YamlNode::Kind::Scalar || !node.key.empty()) return;
    YamlNode scene = node;
    scene.key = "scene";
    scene.key_place = node.place;
    node.kind = YamlNode::Kind::Map;
    node.items = {std::move(scene)};
}

// Sections that need not be written, because all in them has a default.
bool is_optional_section(const std::string& key) {
    return key == "image" || key == "reference" || key == "parameters";
}

YamlNode& descend(YamlNode& node, const std::string& key, const Place& place) {
    make_map(node);
    if (YamlNode* child = find_child(node, key)) return *child;
    if (node.kind == YamlNode::Kind::Map && is_optional_section(key)) {
        YamlNode& section = add_child(node, key, place);
        section.kind = YamlNode::Kind::Map;
        return section;
    }
    fail_at(place, unknown_name("key", key, child_names(node)));
}

}  // namespace

void apply_override(YamlNode& root, const std::string& assignment) {
    const Place place{"--set " + assignment, 0, 0};
    const auto equals = assignment.find('=');
    if (equals == std::string::npos || equals == 0) fail_at(place, "must be PATH=VALUE");
    require_map(root, "the experiment file");

    const std::vector<std::string> keys = split_path(assignment.substr(0, equals));
    YamlNode* node = &root;
    for (std::size_t i = 0; i + 1 < keys.size(); ++i) node = &descend(*node, keys[i], place);
    make_map(*node);
    YamlNode* target = find_child(*node, keys.back());
    if (target == nullptr) {
        if (node->kind != YamlNode::Kind::Map) {
            fail_at(place, unknown_name("key", keys.back(), child_names(*node)));
        }
        target = &add_child(*node, keys.back(), place);
    }
    YamlNode value = parse_yaml(assignment.substr(equals + 1), place.source, false);
    value.key = target->key;
    value.key_place = target->key_place;
    *target = std::move(value);
}

}  // namespace misbench
