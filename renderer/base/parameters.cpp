#include "renderer/base/parameters.h"

#include <nlohmann/json.hpp>

namespace misbench {

void check_choice(const std::string& name, const std::string& value,
                  std::initializer_list<const char*> known) {
    std::string list;
    for (const char* choice : known) {
        if (value == choice) return;
        list.append(" ").append(choice);
    }
    throw ParameterError(name, name + " is '" + value + "'; known:" + list);
}

nlohmann::json parameters_to_json(const ParameterMap& parameters) {
    nlohmann::json json = nlohmann::json::object();
    for (const auto& [key, value] : parameters) {
        std::visit([&json, &name = key](const auto& v) { json[name] = v; }, value);
    }
    return json;
}

ParameterMap parameters_from_json(const nlohmann::json& json) {
    ParameterMap parameters;
    for (const auto& [key, value] : json.items()) {
        if (value.is_boolean()) {
            parameters[key] = value.get<bool>();
        } else if (value.is_number_integer()) {
            parameters[key] = value.get<std::int64_t>();
        } else if (value.is_number()) {
            parameters[key] = value.get<double>();
        } else if (value.is_string()) {
            parameters[key] = value.get<std::string>();
        } else {
            throw Error(Errc::InvalidArgument, "parameter '" + key + "' is not a scalar");
        }
    }
    return parameters;
}

std::string to_string(const ParameterValue& value) {
    if (const auto* text = std::get_if<std::string>(&value)) return *text;
    return parameters_to_json({{"v", value}})["v"].dump();
}

}  // namespace misbench
