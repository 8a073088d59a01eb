// What was found of the bias of methods, in the formats people read or paste and in those that
// programs read.
#pragma once

#include <string>

#include "experiments/analysis/bias.h"
#include "experiments/report/table.h"

namespace misbench {

// Ten bars, of the p values from 0 to 1.
std::string histogram_of(const ScaleTest& scale);

Table bias_table(const Bias& bias);
// A row for each scene, method and scale, an object for each scene and method; in full precision.
std::string bias_to_csv(const Bias& bias);
std::string bias_to_json(const Bias& bias);

}  // namespace misbench
