// What accuracy costs, in the formats people read and in those that programs read.
#pragma once

#include <string>

#include "experiments/analysis/tradeoff.h"

namespace misbench {

// For each scene a table of the methods and one of their points, then a table over all scenes.
std::string tradeoff_to_text(const Tradeoff& tradeoff);
std::string tradeoff_to_markdown(const Tradeoff& tradeoff);
std::string tradeoff_to_json(const Tradeoff& tradeoff);
// One row a point, all numbers in full precision; fits are repeated in each row of their method.
std::string tradeoff_to_csv(const Tradeoff& tradeoff);

// One row for each value of the parameter.
std::string ladders_to_text(const ParameterTradeoff& tradeoff);
std::string ladders_to_markdown(const ParameterTradeoff& tradeoff);
std::string ladders_to_json(const ParameterTradeoff& tradeoff);
std::string ladders_to_csv(const ParameterTradeoff& tradeoff);

}  // namespace misbench
