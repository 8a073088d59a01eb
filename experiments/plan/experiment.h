// An experiment as values: the product of its axes, and what follows from it. Plain data without
// rules of its own; experiment_file.h reads it, resolve.h (one layer up) checks it against the
// renderer's catalogues and makes it a plan.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "experiments/plan/claim.h"
#include "experiments/plan/task.h"

namespace misbench {

// What the images of one scene are compared with: two independent halves, so that the noise of the
// reference cancels from the error.
enum class Role { Test, ReferenceA, ReferenceB };
std::string to_string(Role role);           // "test", "reference_a", "reference_b"
Role role_from_string(const std::string&);  // throws InvalidArgument

// One scene × method × budget × seed of an experiment, and the task that fills it. Several cells
// may share a task (two labels for the same effective parameters).
struct Cell {
    std::string scene;
    std::string method;  // the user's label; "reference" for the reference's halves
    Budget budget;
    std::int64_t seed = 0;
    Role role = Role::Test;
    Task task;
    bool operator==(const Cell&) const = default;
};

// Seeds by need: every cell has the first `min` of its seeds, and further ones up to `max` until
// the half width of the ratio to the baseline, in the first metric, is `ratio_halfwidth` (0.1: 10
// %).
struct SeedRule {
    int min = 0;
    int max = 0;
    double ratio_halfwidth = 0;
    bool operator==(const SeedRule&) const = default;
};

struct PlannedScene {
    std::string name;
    double exposure = 0;  // stops, for display
    bool operator==(const PlannedScene&) const = default;
};

// A resolved experiment: everything that tables and reports need to know about it, in the order in
// which the user wrote it. Stored as JSON with the results.
struct Plan {
    std::string experiment;  // name, the key in a store
    std::string description;
    std::vector<PlannedScene> scenes;
    std::vector<std::string> methods;  // labels
    std::vector<Budget> budgets;
    std::string baseline;              // a label
    std::vector<std::string> metrics;  // ids; the first is the one that tables show by default
    std::vector<Claim> claims = {};    // in the file's order
    // Where it is set, cells may have different numbers of seeds.
    std::optional<SeedRule> seed_rule = std::nullopt;
    std::vector<Cell> cells;    // references first, then tests, seeds outermost
    std::string configuration;  // the effective experiment file, defaults filled in, as JSON
    bool operator==(const Plan&) const = default;
};

nlohmann::json seed_rule_to_json(const SeedRule& rule);  // as in an experiment file

nlohmann::json plan_to_json(const Plan& plan);
Plan plan_from_json(const nlohmann::json& json);  // throws InvalidArgument

}  // namespace misbench
