#include "experiments/plan/unite.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "experiments/plan/imported.h"
#include "experiments/plan/task_difference.h"

namespace misbench {
namespace {

using Place = std::tuple<std::string, std::string, std::string, std::int64_t, Role>;

// A half of a reference has its place whatever it cost.
Place place_of(const Cell& cell) {
    if (cell.role != Role::Test) return {cell.scene, "", "", 0, cell.role};
    return {cell.scene, cell.method, to_string(cell.budget), cell.seed, cell.role};
}

std::string to_text(const Cell& cell) {
    return cell.scene + ", " + (cell.role == Role::Test ? cell.method : to_string(cell.role));
}

// What a label means in a scene, whatever its budget and seed; of an image nothing but that it is
// one.
Task meaning_of(const Cell& cell) {
    Task task = cell.task;
    if (cell.role == Role::Test) {
        task.budget = SampleBudget{};
        task.seed = 0;
        if (is_imported(task)) task.parameters.clear();
    }
    return task;
}

std::optional<std::string> cells_differ(const Plan& a, const Plan& b) {
    std::map<Place, const Cell*> cells;
    std::map<std::tuple<std::string, std::string, Role>, const Cell*> meanings;
    for (const Cell& cell : a.cells) {
        cells.emplace(place_of(cell), &cell);
        meanings.emplace(std::tuple(cell.scene, cell.method, cell.role), &cell);
    }
    for (const Cell& cell : b.cells) {
        if (const auto there = cells.find(place_of(cell)); there != cells.end()) {
            const auto differences = task_differences(there->second->task, cell.task);
            if (!differences.empty()) return to_text(cell) + ": " + to_string(differences);
        }
        const auto there = meanings.find(std::tuple(cell.scene, cell.method, cell.role));
        if (there == meanings.end()) continue;
        const auto differences = task_differences(meaning_of(*there->second), meaning_of(cell));
        if (!differences.empty()) return to_text(cell) + ": " + to_string(differences);
    }
    return std::nullopt;
}

void append_new(auto& values, const auto& others) {
    for (const auto& other : others) {
        if (std::ranges::find(values, other) == values.end()) values.push_back(other);
    }
}

// The file as it would be for both.
std::string unite_configurations(const std::string& a, const std::string& b) {
    nlohmann::json united = nlohmann::json::parse(a);
    const nlohmann::json other = nlohmann::json::parse(b);
    for (const auto& [key, value] : other.items()) {
        if (!united.contains(key)) united[key] = value;
    }
    if (other.contains("methods") && united["methods"].is_object()) {
        for (const auto& [label, method] : other["methods"].items()) {
            if (!united["methods"].contains(label)) united["methods"][label] = method;
        }
    }
    for (const char* key : {"seeds", "budgets", "scenes"}) {
        if (!other.contains(key) || !other[key].is_array() || !united[key].is_array()) continue;
        const auto names = [](const nlohmann::json& entry) {
            return entry.is_object() && entry.contains("scene") ? entry["scene"] : entry;
        };
        for (const auto& entry : other[key]) {
            const auto same = [&](const auto& e) { return names(e) == names(entry); };
            if (std::ranges::none_of(united[key], same)) united[key].push_back(entry);
        }
    }
    // A seed rule is no list.
    if (united.contains("seeds") && united["seeds"].is_array())
        std::sort(united["seeds"].begin(), united["seeds"].end());
    return united.dump();
}

}  // namespace

std::optional<std::string> what_differs(const Plan& a, const Plan& b) {
    const auto differ = [](const std::string& what, const std::string& in_a,
                           const std::string& in_b) {
        return what + " '" + in_a + "', not '" + in_b + "'";
    };
    const auto list = [](const std::vector<std::string>& names) {
        std::string text;
        for (const std::string& name : names) text += (text.empty() ? "" : " ") + name;
        return text;
    };
    if (a.description != b.description) {
        return differ("description", a.description, b.description);
    }
    if (a.metrics != b.metrics) return differ("metrics", list(a.metrics), list(b.metrics));
    if (a.baseline != b.baseline) return differ("baseline", a.baseline, b.baseline);
    if (a.claims != b.claims) return "the claims";
    for (const PlannedScene& scene : a.scenes) {
        const auto same = std::ranges::find(b.scenes, scene.name, &PlannedScene::name);
        if (same == b.scenes.end() || same->exposure == scene.exposure) continue;
        return differ("exposure of " + scene.name, std::to_string(scene.exposure),
                      std::to_string(same->exposure));
    }
    return cells_differ(a, b);
}

Plan unite(const Plan& a, const Plan& b) {
    Plan united = a;
    append_new(united.scenes, b.scenes);
    append_new(united.methods, b.methods);
    append_new(united.budgets, b.budgets);
    if (a.seed_rule != b.seed_rule) united.seed_rule.reset();
    std::set<Place> places;
    for (const Cell& cell : a.cells) places.insert(place_of(cell));
    for (const Cell& cell : b.cells) {
        if (places.insert(place_of(cell)).second) united.cells.push_back(cell);
    }
    united.configuration = unite_configurations(a.configuration, b.configuration);
    sort_cells(united);
    return united;
}

}  // namespace misbench
