// Parameters as they are written in an experiment, stored with a run and hashed into its identity.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <variant>

namespace misbench {

using ParameterValue = std::variant<bool, std::int64_t, double, std::string>;
using ParameterMap = std::map<std::string, ParameterValue>;

// As a user would write it: true, 3, 0.5, power2. Doubles print shortest round-trip.
std::string to_string(const ParameterValue& value);

nlohmann::json parameters_to_json(const ParameterMap& parameters);
// Throws InvalidArgument when a value is not a scalar.
ParameterMap parameters_from_json(const nlohmann::json& json);

}  // namespace misbench
