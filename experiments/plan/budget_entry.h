// A budget as it is written in a file: {samples: N} or {seconds: S, clock: cpu|wall}.
#pragma once

#include "experiments/plan/yaml_reader.h"
#include "renderer/base/budget.h"

namespace misbench {

inline constexpr std::int64_t kMaxSamples = 1'000'000'000;
inline constexpr double kMaxBudgetSeconds = 1e6;

Placed<Budget> read_budget(const YamlNode& node);

}  // namespace misbench
