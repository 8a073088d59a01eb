#include "experiments/report/report_data.h"

#include "experiments/analysis/convergence.h"
#include "experiments/report/table_formats.h"

namespace misbench {
namespace {

nlohmann::ordered_json curve_to_json(const Curve& curve) {
    nlohmann::ordered_json json = {{"scene", curve.scene}, {"method", curve.method}};
    json["points"] = nlohmann::ordered_json::array();
    for (const CurvePoint& point : curve.points) {
        if (!point.mean) continue;
        nlohmann::ordered_json entry = {{"passes", point.passes},
                                        {"cpu_seconds", point.cpu_seconds},
                                        {"wall_seconds", point.wall_seconds},
                                        {"value", point.mean->value}};
        if (const auto& interval = point.mean->interval) {
            entry["interval"] = {interval->low, interval->high};
        }
        json["points"].push_back(std::move(entry));
    }
    return json;
}

nlohmann::ordered_json metric_to_json(const Store& store, const Plan& plan,
                                      const std::string& metric) {
    const Comparison comparison = compare(store, plan, metric);
    auto json = nlohmann::ordered_json::parse(to_json({&comparison, 1}));
    json["curves"] = nlohmann::ordered_json::array();
    for (const Curve& curve : convergence(store, plan, metric)) {
        json["curves"].push_back(curve_to_json(curve));
    }
    return json;
}

}  // namespace

nlohmann::ordered_json report_data(const Store& store, const Plan& plan) {
    nlohmann::ordered_json json = {{"experiment", plan.experiment}, {"baseline", plan.baseline}};
    json["scenes"] = nlohmann::ordered_json::array();
    for (const PlannedScene& scene : plan.scenes) {
        json["scenes"].push_back({{"name", scene.name}, {"exposure", scene.exposure}});
    }
    json["methods"] = plan.methods;
    json["budgets"] = nlohmann::ordered_json::array();
    for (const Budget& budget : plan.budgets) json["budgets"].push_back(to_string(budget));
    json["metrics"] = nlohmann::ordered_json::array();
    for (const std::string& metric : plan.metrics) {
        json["metrics"].push_back(metric_to_json(store, plan, metric));
    }
    return json;
}

std::string embedded_json(const nlohmann::ordered_json& json) {
    std::string text;
    for (const char c : json.dump()) {
        if (c == '<') {
            text += "\\u003c";
        } else {
            text += c;
        }
    }
    return text;
}

}  // namespace misbench
