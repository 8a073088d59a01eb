// Why two tasks are not one: the fields of their identities that differ.
#pragma once

#include <string>
#include <vector>

#include "experiments/plan/task.h"

namespace misbench {

struct TaskDifference {
    std::string field;  // "scene content", "image size", "method", "parameter max_depth", …
    std::string a;      // "" where there is none
    std::string b;
    bool operator==(const TaskDifference&) const = default;
};

// Empty exactly when both have the same id.
std::vector<TaskDifference> task_differences(const Task& a, const Task& b);

// "parameter max_depth 5, not 6; seed 1, not 2"
std::string to_string(const std::vector<TaskDifference>& differences);

}  // namespace misbench
