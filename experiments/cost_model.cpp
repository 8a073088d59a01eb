#include "experiments/cost_model.h"

namespace misbench {

Cost CostModel::estimate(const Task& task) {
    if (const auto* time = std::get_if<TimeBudget>(&task.budget)) return {time->seconds, false};
    const auto key = std::pair(task.scene_hash, task.method);
    auto known = per_sample_.find(key);
    if (known == per_sample_.end()) {
        const auto seen = store_ == nullptr
                              ? std::nullopt
                              : store_->seconds_per_sample(task.scene_hash, task.method);
        const Cost cost{seen.value_or(kGuessedSecondsPerSample), !seen.has_value()};
        known = per_sample_.emplace(key, cost).first;
    }
    const double n_samples = static_cast<double>(task.width) * static_cast<double>(task.height) *
                             static_cast<double>(std::get<SampleBudget>(task.budget).samples);
    return {n_samples * known->second.seconds, known->second.is_guess};
}

}  // namespace misbench
