// Integrands and densities as a laboratory file writes them: a shape, or a list of them to add.
#pragma once

#include <string>

#include "experiments/lab/curve.h"
#include "experiments/plan/yaml_reader.h"

namespace misbench::lab {

// [low, high]
Domain read_interval(const YamlNode& node, const std::string& what);
Curve read_curve(const YamlNode& node, const Domain& domain);
// The curve, normalised. An error where it is below 0 or 0 everywhere.
Density read_density(const YamlNode& node, const Domain& domain);

}  // namespace misbench::lab
