// What a run may spend: a number of passes (samples a pixel), or seconds.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <variant>

namespace misbench {

enum class BudgetClock {
    Cpu,   // CPU seconds, summed over the render threads: immune to a neighbour who takes turns
    Wall,  // seconds of the steady clock
};

struct SampleBudget {
    std::int64_t samples = 1;
    bool operator==(const SampleBudget&) const = default;
};

struct TimeBudget {
    double seconds = 1;
    BudgetClock clock = BudgetClock::Cpu;
    bool operator==(const TimeBudget&) const = default;
};

using Budget = std::variant<SampleBudget, TimeBudget>;

// For people and as a stable key: "16 spp", "2 s cpu", "0.5 s wall".
std::string to_string(const Budget& budget);
// The budget that to_string() writes so. Throws ParameterError for anything else.
Budget budget_from_string(const std::string& text);

// {"samples": 16} or {"seconds": 2.0, "clock": "cpu"}.
nlohmann::json budget_to_json(const Budget& budget);
Budget budget_from_json(const nlohmann::json& json);

}  // namespace misbench
