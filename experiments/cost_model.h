// How long a task will take, from the runs a store has seen.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "experiments/plan/task.h"
#include "results/store.h"

namespace misbench {

struct Cost {
    double seconds = 0;     // on a worker with one render thread
    bool is_guess = false;  // no run of this scene and method has been seen
};

// What a sample of a pixel is taken to cost where nothing is known: a path of a few edges with next
// event estimation, about ten rays.
inline constexpr double kGuessedSecondsPerSample = 3e-6;

class CostModel {
 public:
    // `store` may be null: then everything is a guess, but for budgets in seconds.
    explicit CostModel(const Store* store) : store_(store) {}
    Cost estimate(const Task& task);

 private:
    const Store* store_;
    std::map<std::pair<std::string, std::string>, Cost> per_sample_;  // by scene hash and method
};

}  // namespace misbench
