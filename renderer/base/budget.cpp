#include "renderer/base/budget.h"

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "renderer/base/error.h"

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

Budget budget_from_string(const std::string& text) {
    const auto number_before = [&text](std::string_view unit, auto number) {
        const char* end = text.data() + text.size() - std::min(unit.size(), text.size());
        const auto [stop, error] = std::from_chars(text.data(), end, number);
        const bool is_whole = text.ends_with(unit) && error == std::errc{} && stop == end;
        return is_whole ? std::optional(number) : std::nullopt;
    };
    if (const auto samples = number_before(" spp", std::int64_t{0}); samples && *samples > 0) {
        return SampleBudget{*samples};
    }
    for (const BudgetClock clock : {BudgetClock::Cpu, BudgetClock::Wall}) {
        const auto seconds = number_before(clock == BudgetClock::Cpu ? " s cpu" : " s wall", 0.0);
        if (seconds && *seconds > 0 && std::isfinite(*seconds)) return TimeBudget{*seconds, clock};
    }
    throw ParameterError(
        "budget", "budget '" + text + "': must be such as '16 spp', '2 s cpu' or '0.5 s wall'");
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
