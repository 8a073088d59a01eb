// The formats of table_formats.h that programs read.
#include <nlohmann/json.hpp>

#include "experiments/report/table_formats.h"

namespace misbench {
namespace {

nlohmann::ordered_json estimate_to_json(const std::optional<Estimate>& estimate) {
    if (!estimate) return nullptr;
    nlohmann::ordered_json json = {{"value", estimate->value}};
    if (estimate->interval) json["interval"] = {estimate->interval->low, estimate->interval->high};
    if (estimate->why_none) json["no_interval"] = to_string(*estimate->why_none);
    return json;
}

nlohmann::ordered_json number_or_null(const std::optional<double>& number) {
    return number ? nlohmann::ordered_json(*number) : nlohmann::ordered_json();
}

nlohmann::ordered_json cell_to_json(const ComparedCell& cell) {
    nlohmann::ordered_json json = {{"scene", cell.scene},
                                   {"method", cell.method},
                                   {"budget", to_string(cell.budget)},
                                   {"planned", cell.n_planned},
                                   {"measured", cell.n_measured},
                                   {"invalid", cell.n_invalid},
                                   {"failed", cell.n_failed},
                                   {"unfinished", cell.n_unfinished},
                                   {"without_reference", cell.n_unreferenced},
                                   {"values", cell.values},
                                   {"seeds", cell.seeds},
                                   {"mean", estimate_to_json(cell.mean)},
                                   {"ratio", estimate_to_json(cell.ratio)},
                                   {"ratio_is_paired", cell.ratio_is_paired},
                                   {"p", number_or_null(cell.p)},
                                   {"adjusted_p", number_or_null(cell.adjusted_p)},
                                   {"ratio_excludes_one", cell.ratio_excludes_one()},
                                   {"baseline", cell.is_baseline},
                                   {"few_passes", cell.few_passes},
                                   {"passes", cell.mean_passes},
                                   {"wall_seconds", cell.mean_wall_seconds},
                                   {"cpu_seconds", cell.mean_cpu_seconds}};
    json["mean_of_scenes"] = cell.is_mean_of_scenes;
    json["tail"] = number_or_null(cell.tail);
    json["tail_verdict"] = to_string(cell.tail_verdict);
    json["reference_share"] = number_or_null(cell.reference_share);
    json["noisy_reference"] = cell.has_noisy_reference();
    return json;
}

std::string full_precision(double value) { return nlohmann::json(value).dump(); }

// "value,low,high", empty where there is none.
std::string estimate_to_csv(const std::optional<Estimate>& estimate) {
    if (!estimate) return ",,";
    std::string csv = full_precision(estimate->value) + ",";
    if (!estimate->interval) return csv + ",";
    return csv + full_precision(estimate->interval->low) + "," +
           full_precision(estimate->interval->high);
}

std::string number_or_empty(const std::optional<double>& number) {
    return number ? full_precision(*number) : "";
}

std::string cell_to_csv(const Comparison& comparison, const ComparedCell& cell) {
    std::string csv;
    for (const std::string& text : {comparison.experiment, comparison.metric, cell.scene,
                                    cell.method, to_string(cell.budget)}) {
        csv += escape_csv(text) + ",";
    }
    for (const int count : {cell.n_planned, cell.n_measured, cell.n_invalid, cell.n_failed,
                            cell.n_unfinished, cell.n_unreferenced}) {
        csv += std::to_string(count) + ",";
    }
    csv += estimate_to_csv(cell.mean) + "," + estimate_to_csv(cell.ratio) + ",";
    for (const bool flag : {cell.ratio_is_paired, cell.ratio_excludes_one()}) {
        csv += flag ? "true," : "false,";
    }
    csv += number_or_empty(cell.p) + "," + number_or_empty(cell.adjusted_p) + ",";
    for (const bool flag : {cell.is_baseline, cell.few_passes}) csv += flag ? "true," : "false,";
    csv += number_or_empty(cell.tail) + "," + to_string(cell.tail_verdict) + "," +
           number_or_empty(cell.reference_share) + ",";
    return csv + full_precision(cell.mean_passes) + "," + full_precision(cell.mean_wall_seconds) +
           "," + full_precision(cell.mean_cpu_seconds) + "\n";
}

nlohmann::ordered_json comparison_to_json(const Comparison& comparison) {
    nlohmann::ordered_json json = {
        {"experiment", comparison.experiment}, {"metric", comparison.metric},
        {"formula", comparison.formula},       {"better", to_string(comparison.better)},
        {"baseline", comparison.baseline},     {"confidence", kConfidence},
        {"scenes", comparison.scenes},         {"methods", comparison.methods}};
    json["cells"] = nlohmann::ordered_json::array();
    for (const ComparedCell& cell : comparison.cells) json["cells"].push_back(cell_to_json(cell));
    return json;
}

}  // namespace

std::string escape_csv(std::string_view text) {
    if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"') quoted += '"';
        quoted += c;
    }
    return quoted + "\"";
}

std::string to_csv(std::span<const Comparison> comparisons) {
    std::string csv =
        "experiment,metric,scene,method,budget,planned,measured,invalid,failed,unfinished,"
        "without_reference,mean,mean_low,mean_high,ratio,ratio_low,ratio_high,ratio_is_paired,"
        "ratio_excludes_one,p,adjusted_p,baseline,few_passes,tail,tail_verdict,"
        "reference_share,passes,wall_seconds,cpu_seconds\n";
    for (const Comparison& comparison : comparisons) {
        for (const ComparedCell& cell : comparison.cells) csv += cell_to_csv(comparison, cell);
    }
    return csv;
}

std::string to_json(std::span<const Comparison> comparisons) {
    auto json = nlohmann::ordered_json::array();
    for (const Comparison& comparison : comparisons) json.push_back(comparison_to_json(comparison));
    return (json.size() == 1 ? json.front() : json).dump(2) + "\n";
}

}  // namespace misbench
