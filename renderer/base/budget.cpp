#include "renderer/base/budget.h"

#include <nlohmann/json.hpp>

namespace misbench {

std::string to_string(const Budget& budget) {
    if (const auto* samples = std::get_if<SampleBudget>(&budget)) {
        return std::to_string(samples->samples) + " spp";
    }
    const auto& time = std::get<TimeBudget>(budget);
    std::string seconds = nlohmann::json(time.seconds).dump();
    if (seconds.ends_with(".0")) seconds.resize(seconds.size() - 2);
    return seconds + (time.clock == BudgetClock::Cpu ? " s cpu" : " s wall");
}

nlohmann::json budget_to_json(const Budget& budget) {
    if (const auto* samples = std::get_if<SampleBudget>(&budget)) {
        return {{"samples", samples->samples}};
    }
    const auto& time = std::get<TimeBudget>(budget);
    return {{"seconds", time.seconds}, {"clock", time.clock == BudgetClock::Cpu ? "cpu" : "wall"}};
}

Budget budget_from_json(const nlohmann::json& json) {
    if (json.contains("samples")) return SampleBudget{json.at("samples").get<std::int64_t>()};
    return TimeBudget{json.at("seconds").get<double>(),
                      json.at("clock") == "cpu" ? BudgetClock::Cpu : BudgetClock::Wall};
}

}  // namespace misbench
