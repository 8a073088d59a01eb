#include "experiments/plan/budget_entry.h"

#include "experiments/plan/suggestion.h"

namespace misbench {

Placed<Budget> read_budget(const YamlNode& node) {
    require_keys(node, "a budget", {"samples", "seconds", "clock"});
    const YamlNode* samples = node.find("samples");
    const YamlNode* seconds = node.find("seconds");
    const YamlNode* clock = node.find("clock");
    if ((samples == nullptr) == (seconds == nullptr)) {
        fail_at(node.place, "a budget has either 'samples' or 'seconds'");
    }
    if (samples != nullptr) {
        if (clock != nullptr) fail_at(clock->key_place, "only a budget in seconds has a clock");
        return {SampleBudget{read_integer(*samples, "samples", 1, kMaxSamples)}, node.place};
    }
    TimeBudget time{.seconds = read_number(*seconds, "seconds")};
    if (time.seconds <= 0 || time.seconds > kMaxBudgetSeconds) {
        fail_at(seconds->place, "seconds must be above 0 and at most 1e6: found " + seconds->text);
    }
    if (clock != nullptr) {
        const std::string name = read_text(*clock, "clock");
        if (name != "cpu" && name != "wall") {
            fail_at(clock->place, unknown_name("clock", name, {"cpu", "wall"}));
        }
        time.clock = name == "cpu" ? BudgetClock::Cpu : BudgetClock::Wall;
    }
    return {time, node.place};
}

}  // namespace misbench
