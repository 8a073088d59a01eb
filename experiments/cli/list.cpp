// misbench list: what can be written in an experiment.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "experiments/cli/output.h"
#include "experiments/cli/verbs.h"
#include "experiments/scene_lookup.h"
#include "renderer/methods/catalogue.h"
#include "renderer/mis/heuristics.h"
#include "renderer/weights/parameters.h"
#include "results/metrics/metrics.h"

namespace misbench {
namespace {

using Json = nlohmann::ordered_json;
using Rows = std::vector<std::vector<std::string>>;

void list_methods(Json& json, std::string& text) {
    for (const MethodInfo& method : methods()) {
        Json parameters = Json::array();
        Rows rows;
        for (const ParameterInfo& parameter : method.parameters()) {
            parameters.push_back(
                {{"name", parameter.name},
                 {"default", parameters_to_json({{"v", parameter.default_value}})["v"]},
                 {"help", parameter.help}});
            rows.push_back(
                {"", parameter.name, "= " + to_string(parameter.default_value), parameter.help});
        }
        json.push_back({{"name", method.name},
                        {"version", method.version},
                        {"summary", method.summary},
                        {"may_be_negative", method.may_be_negative},
                        {"parameters", parameters}});
        text += fmt::format("{} (version {}): {}\n{}", method.name, method.version, method.summary,
                            align(rows));
    }
}

void list_heuristics(Json& json, std::string& text) {
    Rows rows;
    for (const MisHeuristic& heuristic : heuristics()) {
        Json entry = {{"name", heuristic.name}, {"formula", heuristic.formula}};
        std::string number;
        if (!heuristic.parameter.empty()) {
            entry["parameter"] = {{"name", heuristic.parameter},
                                  {"default", heuristic.default_parameter},
                                  {"above", heuristic.min_parameter},
                                  {"below", heuristic.max_parameter}};
            number = fmt::format("{}{:g}: {} = {:g}", heuristic.name, heuristic.default_parameter,
                                 heuristic.parameter, heuristic.default_parameter);
        }
        json.push_back(std::move(entry));
        rows.push_back({std::string(heuristic.name), std::string(heuristic.formula), number});
    }
    text = align(rows);
}

void list_factors(Json& json, std::string& text) {
    Rows rows;
    for (const FactorInfo& factor : factor_infos()) {
        json.push_back({{"name", factor.name}, {"summary", factor.summary}});
        rows.push_back({std::string(factor.name), std::string(factor.summary)});
    }
    text = align(rows);
}

void list_metrics(Json& json, std::string& text) {
    Rows rows;
    for (const Metric& metric : metrics()) {
        json.push_back({{"id", metric.id},
                        {"formula", metric.formula},
                        {"better", to_string(metric.better)},
                        {"aggregation", aggregation(metric)},
                        {"has_map", metric.map != nullptr}});
        rows.push_back({std::string(metric.id), std::string(metric.formula),
                        metric.better == Direction::None ? "ranks nothing"
                                                         : to_string(metric.better) + " is better",
                        aggregation(metric)});
    }
    text = align(rows);
}

void list_scene_files(const std::string& folder, Json& json, std::string& text) {
    Rows rows;
    for (const SceneListing& scene : list_scenes(scene_folder(folder))) {
        json.push_back({{"name", scene.name}, {"file", scene.file.string()}});
        rows.push_back({scene.name, scene.file.string()});
    }
    text = align(rows);
}

}  // namespace

int list_verb(const ListOptions& options) {
    Json json = Json::array();
    std::string text;
    if (options.what == "methods") list_methods(json, text);
    if (options.what == "heuristics") list_heuristics(json, text);
    if (options.what == "factors") list_factors(json, text);
    if (options.what == "metrics") list_metrics(json, text);
    if (options.what == "scenes") list_scene_files(options.scenes, json, text);
    print_result(options.json ? json.dump(2) + "\n" : text);
    return 0;
}

}  // namespace misbench
