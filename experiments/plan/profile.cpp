#include "experiments/plan/profile.h"

#include <algorithm>

#include "experiments/plan/suggestion.h"

namespace misbench {
namespace {

void merge(YamlNode& into, const YamlNode& from) {
    for (const YamlNode& value : from.items) {
        YamlNode* target = into.find(value.key);
        if (target == nullptr) {
            into.items.push_back(value);
        } else if (target->kind == YamlNode::Kind::Map && value.kind == YamlNode::Kind::Map) {
            merge(*target, value);
        } else {
            *target = value;
        }
    }
}

void check_profile(const YamlNode& profile) {
    YamlNode key = profile;
    key.kind = YamlNode::Kind::Scalar;
    key.text = profile.key;
    key.place = profile.key_place;
    read_word(key, "the name of a profile");
    require_map(profile, "profile '" + profile.key + "'");
    for (const char* fixed : {"name", "profiles"}) {
        if (const YamlNode* value = profile.find(fixed)) {
            fail_at(value->key_place, std::string("a profile cannot override '") + fixed + "'");
        }
    }
}

}  // namespace

ChosenProfile apply_profile(YamlNode& root, const std::string& name) {
    const YamlNode* found = root.find("profiles");
    if (found == nullptr) {
        if (name.empty()) return {};
        fail_at({"--profile " + name, 0, 0}, "the experiment file has no profiles");
    }
    const YamlNode profiles = *found;
    require_map(profiles, "profiles");
    if (profiles.items.empty()) fail_at(profiles.place, "profiles must not be empty");
    ChosenProfile chosen{.name = name.empty() ? profiles.items.front().key : name, .known = {}};
    for (const YamlNode& profile : profiles.items) {
        check_profile(profile);
        chosen.known.push_back(profile.key);
    }
    const YamlNode* profile = profiles.find(chosen.name);
    if (profile == nullptr) {
        fail_at({"--profile " + name, 0, 0}, unknown_name("profile", name, chosen.known));
    }
    std::erase_if(root.items, [](const YamlNode& item) { return item.key == "profiles"; });
    merge(root, *profile);
    YamlNode* experiment = root.find("name");
    if (experiment != nullptr && chosen.name != chosen.known.front()) {
        experiment->text += "-" + chosen.name;
    }
    return chosen;
}

}  // namespace misbench
