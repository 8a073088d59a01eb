#include "experiments/plan/imported.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <tuple>

#include "experiments/plan/suggestion.h"
#include "renderer/base/error.h"
#include "renderer/base/sha256.h"

namespace misbench {
namespace {

constexpr std::string_view kPrefix = "imported:";

bool contains(const auto& values, const auto& value) {
    return std::ranges::find(values, value) != values.end();
}

auto index_of(const auto& values, const auto& value) {
    return std::ranges::find(values, value) - values.begin();
}

std::vector<std::string> scene_names(const Plan& plan) {
    std::vector<std::string> names;
    for (const PlannedScene& scene : plan.scenes) names.push_back(scene.name);
    return names;
}

std::string size_of(const Task& task) {
    return std::to_string(task.width) + "x" + std::to_string(task.height);
}

// A half of a reference has its place whatever it cost.
bool is_same_place(const Cell& a, const Cell& b) {
    if (a.role != b.role || a.scene != b.scene) return false;
    return a.role != Role::Test ||
           (a.method == b.method && a.budget == b.budget && a.seed == b.seed);
}

[[noreturn]] void refuse(const Plan& plan, const std::string& what) {
    throw Error(Errc::InvalidArgument, "experiment '" + plan.experiment + "': " + what);
}

bool is_rendered(const Plan& plan) {
    return std::ranges::any_of(plan.cells, [](const Cell& c) { return !is_imported(c.task); });
}

void require_label_is_free(const Plan& plan, const std::string& label) {
    for (const Cell& cell : plan.cells) {
        if (cell.role == Role::Test && cell.method == label && !is_imported(cell.task)) {
            refuse(plan, "method '" + label +
                             "' is one that misbench renders; imported images need another label");
        }
    }
}

// What the plan says of the scene: a cell of it, one that is rendered if there is any.
const Cell* cell_of_scene(const Plan& plan, const std::string& scene) {
    const Cell* found = nullptr;
    for (const Cell& cell : plan.cells) {
        if (cell.scene != scene) continue;
        if (found == nullptr || !is_imported(cell.task)) found = &cell;
        if (!is_imported(found->task)) break;
    }
    return found;
}

// The experiment's description names every method; those of images are not in its file.
void describe(Plan& plan, const Cell& cell) {
    nlohmann::json configuration = nlohmann::json::parse(plan.configuration);
    ParameterMap parameters = cell.task.parameters;
    parameters.erase(kImportParameter);
    const nlohmann::json method = {{"method", cell.task.method},
                                   {"version", cell.task.method_version},
                                   {"parameters", parameters_to_json(parameters)}};
    if (cell.role == Role::Test) {
        configuration["methods"][cell.method] = method;
    } else if (!configuration.contains(kReferenceLabel)) {
        configuration[kReferenceLabel] = method;
    }
    plan.configuration = configuration.dump();
}

void add(Plan& plan, const Cell& cell) {
    if (!contains(scene_names(plan), cell.scene)) plan.scenes.push_back({.name = cell.scene});
    if (cell.role == Role::Test) {
        if (!contains(plan.methods, cell.method)) plan.methods.push_back(cell.method);
        if (!contains(plan.budgets, cell.budget)) plan.budgets.push_back(cell.budget);
        if (plan.baseline.empty()) plan.baseline = cell.method;
    }
    describe(plan, cell);
    plan.cells.push_back(cell);
}

std::string label_of(const Cell& cell) {
    return cell.role == Role::Test ? cell.method : kReferenceLabel;
}

// Takes out what only the cell that has left had.
void forget_unused(Plan& plan, const Cell& gone) {
    const auto has_cell = [&plan](auto is_it) { return std::ranges::any_of(plan.cells, is_it); };
    if (!has_cell([&gone](const Cell& cell) { return cell.scene == gone.scene; })) {
        std::erase_if(plan.scenes, [&gone](const auto& scene) { return scene.name == gone.scene; });
    }
    if (gone.role != Role::Test) return;
    const auto has_test = [&](auto Cell::*field) {
        return has_cell([&gone, field](const Cell& cell) {
            return cell.role == Role::Test && cell.*field == gone.*field;
        });
    };
    if (!has_test(&Cell::budget)) std::erase(plan.budgets, gone.budget);
    if (has_test(&Cell::method)) return;
    std::erase(plan.methods, gone.method);
    nlohmann::json configuration = nlohmann::json::parse(plan.configuration);
    configuration["methods"].erase(gone.method);
    plan.configuration = configuration.dump();
    if (plan.baseline == gone.method) plan.baseline = plan.methods.empty() ? "" : plan.methods[0];
}

}  // namespace

std::string imported_method(const std::string& label) { return std::string(kPrefix) + label; }

bool is_imported(const Task& task) { return task.method.starts_with(kPrefix); }

std::string imported_scene_hash(const std::string& scene) {
    return sha256_hex(std::string(kPrefix) + scene);
}

std::vector<std::string> scenes_without_reference(const Plan& plan) {
    std::vector<std::string> scenes = scene_names(plan);
    std::erase_if(scenes, [&plan](const std::string& scene) {
        return std::ranges::any_of(plan.cells, [&scene](const Cell& cell) {
            return cell.scene == scene && cell.role != Role::Test;
        });
    });
    return scenes;
}

void sort_cells(Plan& plan) {
    const std::vector<std::string> scenes = scene_names(plan);
    const auto key = [&](const Cell& cell) {
        const bool is_test = cell.role == Role::Test;
        return std::tuple(
            is_test, is_test ? cell.seed : 0, is_test ? index_of(plan.budgets, cell.budget) : 0,
            index_of(scenes, cell.scene), cell.role, index_of(plan.methods, cell.method));
    };
    std::ranges::stable_sort(plan.cells, {}, key);
}

void add_imported(Plan& plan, const Cell& cell, bool replace) {
    if (cell.role == Role::Test) require_label_is_free(plan, cell.method);
    const Cell* scene = cell_of_scene(plan, cell.scene);
    if (scene == nullptr && is_rendered(plan)) {
        refuse(plan, unknown_name("scene", cell.scene, scene_names(plan)));
    }
    if (scene != nullptr && size_of(scene->task) != size_of(cell.task)) {
        refuse(plan, "images of scene '" + cell.scene + "' have " + size_of(scene->task) +
                         " pixels, this one " + size_of(cell.task));
    }
    const auto there =
        std::ranges::find_if(plan.cells, [&](const Cell& c) { return is_same_place(c, cell); });
    if (there != plan.cells.end()) {
        if (there->task == cell.task) return;
        const std::string place = cell.role == Role::Test
                                      ? cell.scene + ", " + cell.method + ", " +
                                            to_string(cell.budget) + ", seed " +
                                            std::to_string(cell.seed)
                                      : to_string(cell.role) + " of scene '" + cell.scene + "'";
        if (!is_imported(there->task)) refuse(plan, place + " is one that misbench renders");
        if (!replace) {
            refuse(plan, place + " has another image, or other facts of it; --replace replaces it");
        }
        plan.cells.erase(there);
    }
    add(plan, cell);
}

int remove_imported(Plan& plan, const std::string& label, const std::string& scene) {
    std::vector<std::string> labels;
    for (const Cell& cell : plan.cells) {
        if (is_imported(cell.task) && !contains(labels, label_of(cell))) {
            labels.push_back(label_of(cell));
        }
    }
    require_label_is_free(plan, label);
    if (!contains(labels, label)) refuse(plan, unknown_name("imported method", label, labels));
    if (!scene.empty() && !contains(scene_names(plan), scene)) {
        refuse(plan, unknown_name("scene", scene, scene_names(plan)));
    }
    for (const Claim& claim : plan.claims) {
        if (claim.method == label || claim.against == label) {
            refuse(plan, "the claim '" + claim.text + "' is about '" + label + "'");
        }
    }
    const auto is_kept = [&](const Cell& cell) {
        return !is_imported(cell.task) || label_of(cell) != label ||
               (!scene.empty() && cell.scene != scene);
    };
    const auto first = std::ranges::stable_partition(plan.cells, is_kept).begin();
    const std::vector<Cell> removed(first, plan.cells.end());
    plan.cells.erase(first, plan.cells.end());
    for (const Cell& cell : removed) forget_unused(plan, cell);
    return static_cast<int>(removed.size());
}

std::vector<std::string> keep_imported(Plan& plan, const Plan& before) {
    std::vector<std::string> left_out;
    const Plan rendered = plan;
    for (const Cell& cell : before.cells) {
        const auto same = [&cell](const Cell& c) { return is_same_place(c, cell); };
        if (!is_imported(cell.task)) continue;
        if (cell.role == Role::Test) require_label_is_free(rendered, cell.method);
        const auto there = std::ranges::find_if(plan.cells, same);
        const std::string what =
            "'" + cell.scene + "', " + cell.method + ", seed " + std::to_string(cell.seed) + ": ";
        if (there != plan.cells.end()) {
            if (!is_imported(there->task)) {
                left_out.push_back(what + "the experiment has its own reference");
            }
            continue;
        }
        const Cell* scene = cell_of_scene(rendered, cell.scene);
        const bool is_by_name = cell.task.scene_hash == imported_scene_hash(cell.scene);
        if (scene == nullptr && !is_by_name) {
            left_out.push_back(what + "the experiment has no such scene any more");
        } else if (scene != nullptr && size_of(scene->task) != size_of(cell.task)) {
            left_out.push_back(what + "the image has " + size_of(cell.task) +
                               " pixels, the scene's have " + size_of(scene->task));
        } else if (scene != nullptr && !is_by_name &&
                   scene->task.scene_hash != cell.task.scene_hash) {
            left_out.push_back(what + "the scene has changed since");
        } else {
            add(plan, cell);
        }
    }
    if (plan.cells.size() > rendered.cells.size()) sort_cells(plan);
    return left_out;
}

}  // namespace misbench
