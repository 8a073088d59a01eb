// Everything that follows from a parameter struct's list of fields: parsing with types checked,
// defaults filled in, help. A struct P lists its fields once:
//
//     static void fields(auto& self, auto&& field) { field("max_depth", self.max_depth, "…"); }
//     void check();  // throws ParameterError for values that cannot be; writes each value in the
//                    // one way that identifies it
#pragma once

#include <cmath>
#include <concepts>
#include <type_traits>

#include "renderer/base/error.h"
#include "renderer/methods/method.h"

namespace misbench {

template <class P>
std::vector<ParameterInfo> parameter_infos() {
    P defaults;
    std::vector<ParameterInfo> infos;
    P::fields(defaults, [&](const char* name, const auto& value, const char* help) {
        infos.push_back({name, value, help});
    });
    return infos;
}

namespace detail {

template <class T>
constexpr const char* type_name() {
    if constexpr (std::same_as<T, bool>) return "true or false";
    if constexpr (std::same_as<T, std::int64_t>) return "an integer";
    if constexpr (std::same_as<T, double>) return "a finite number";
    if constexpr (std::same_as<T, std::string>) return "a text";
}

template <class T>
void assign(const std::string& name, const ParameterValue& given, T& field) {
    if (const auto* value = std::get_if<T>(&given)) {
        field = *value;
    } else if constexpr (std::same_as<T, double>) {
        const auto* integer = std::get_if<std::int64_t>(&given);
        field = integer != nullptr ? static_cast<double>(*integer) : std::nan("");
    } else {
        throw ParameterError(name, "parameter '" + name + "' is '" + to_string(given) +
                                       "', expected " + type_name<T>());
    }
    if constexpr (std::same_as<T, double>) {
        if (!std::isfinite(field)) {
            throw ParameterError(name, "parameter '" + name + "' is '" + to_string(given) +
                                           "', expected " + type_name<T>());
        }
    }
}

}  // namespace detail

template <class P>
P parse_parameters(const ParameterMap& given) {
    P parameters;
    std::string known;
    ParameterMap rest = given;
    P::fields(parameters, [&](const char* name, auto& field, const char*) {
        known += std::string(" ") + name;
        if (const auto node = rest.extract(name)) detail::assign(name, node.mapped(), field);
    });
    if (!rest.empty()) {
        const std::string& name = rest.begin()->first;
        throw ParameterError(name, "unknown parameter '" + name + "'; known:" + known);
    }
    parameters.check();
    return parameters;
}

template <class P>
ParameterMap effective_parameters(const ParameterMap& given) {
    const P parameters = parse_parameters<P>(given);
    ParameterMap map;
    P::fields(parameters,
              [&](const char* name, const auto& value, const char*) { map.emplace(name, value); });
    return map;
}

// The catalogue's row of a method that make(parameters) makes of parameters P; a lambda without
// captures.
template <class P, class Make>
constexpr MethodInfo method_info(std::string_view name, std::string_view summary, int version,
                                 bool may_be_negative, std::string (*limits)(const SceneFeatures&),
                                 Make /*make*/) {
    return {.name = name,
            .summary = summary,
            .version = version,
            .may_be_negative = may_be_negative,
            .limits = limits,
            .parameters = parameter_infos<P>,
            .effective = effective_parameters<P>,
            .make = [](const ParameterMap& given) -> std::unique_ptr<Method> {
                return Make{}(parse_parameters<P>(given));
            }};
}

// Of a method M that is constructed from its parameters P.
template <class M, class P>
constexpr MethodInfo method_info_of(std::string_view name, std::string_view summary, int version,
                                    bool may_be_negative,
                                    std::string (*limits)(const SceneFeatures&)) {
    return method_info<P>(name, summary, version, may_be_negative, limits,
                          [](const P& parameters) { return std::make_unique<M>(parameters); });
}

}  // namespace misbench
