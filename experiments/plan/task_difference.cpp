#include "experiments/plan/task_difference.h"

#include <set>

#include "experiments/plan/imported.h"

namespace misbench {
namespace {

// Its parameter is a hash, which says nothing to people.
const std::string kImportedImage = "imported image";

std::string size_of(const Task& task) {
    return std::to_string(task.width) + "x" + std::to_string(task.height);
}

// Which file it is, and enough of the hash to tell it from another one.
std::string content_of(const Task& task) {
    const std::string hash = task.scene_hash.substr(0, 12);
    return task.scene_file.empty() ? hash : "of " + task.scene_file + " (" + hash + ")";
}

std::string value_of(const ParameterMap& parameters, const std::string& key) {
    const auto found = parameters.find(key);
    return found == parameters.end() ? "" : to_string(found->second);
}

}  // namespace

std::vector<TaskDifference> task_differences(const Task& a, const Task& b) {
    std::vector<TaskDifference> differences;
    const auto compare = [&differences](const std::string& field, const std::string& in_a,
                                        const std::string& in_b) {
        if (in_a != in_b) differences.push_back({field, in_a, in_b});
    };
    if (a.scene_hash != b.scene_hash) compare("scene content", content_of(a), content_of(b));
    compare("image size", size_of(a), size_of(b));
    compare("method", a.method, b.method);
    compare("method version", std::to_string(a.method_version), std::to_string(b.method_version));
    std::set<std::string> keys;
    for (const auto& [key, value] : a.parameters) keys.insert(key);
    for (const auto& [key, value] : b.parameters) keys.insert(key);
    for (const std::string& key : keys) {
        const auto in_a = a.parameters.find(key);
        const auto in_b = b.parameters.find(key);
        const bool is_same = in_a != a.parameters.end() && in_b != b.parameters.end() &&
                             in_a->second == in_b->second;
        if (is_same) continue;
        differences.push_back({key == kImportParameter ? kImportedImage : "parameter " + key,
                               value_of(a.parameters, key), value_of(b.parameters, key)});
    }
    compare("budget", to_string(a.budget), to_string(b.budget));
    compare("seed", std::to_string(a.seed), std::to_string(b.seed));
    return differences;
}

std::string to_string(const std::vector<TaskDifference>& differences) {
    const auto shown = [](const std::string& value) { return value.empty() ? "none" : value; };
    std::string text;
    for (const auto& [field, a, b] : differences) {
        if (field == kImportedImage) {
            text += (text.empty() ? "" : "; ") + field + " another one, or other facts of it";
            continue;
        }
        text += (text.empty() ? "" : "; ") + field + " " + shown(a) + ", not " + shown(b);
    }
    return text;
}

}  // namespace misbench
