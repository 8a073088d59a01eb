// Parameters as they are written in an experiment, stored with a run and hashed into its identity.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <variant>

#include "renderer/base/error.h"

namespace misbench {

using ParameterValue = std::variant<bool, std::int64_t, double, std::string>;
using ParameterMap = std::map<std::string, ParameterValue>;

// As a user would write it: true, 3, 0.5, power2. Doubles print shortest round-trip.
std::string to_string(const ParameterValue& value);

// Throws ParameterError "NAME must lie between LOW and HIGH", both inclusive.
template <class T>
void check_range(const std::string& name, T value, T low, T high) {
    if (value >= low && value <= high) return;
    throw ParameterError(name, name + " must lie between " + to_string(ParameterValue(low)) +
                                   " and " + to_string(ParameterValue(high)));
}
// Throws ParameterError "NAME is 'VALUE'; known: A B".
void check_choice(const std::string& name, const std::string& value,
                  std::initializer_list<const char*> known);

nlohmann::json parameters_to_json(const ParameterMap& parameters);
// Throws InvalidArgument when a value is not a scalar.
ParameterMap parameters_from_json(const nlohmann::json& json);

}  // namespace misbench
