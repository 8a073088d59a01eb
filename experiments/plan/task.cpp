#include "experiments/plan/task.h"

#include <nlohmann/json.hpp>

#include "renderer/base/error.h"
#include "renderer/base/sha256.h"

namespace misbench {
namespace {

nlohmann::json identity_to_json(const Task& task) {
    nlohmann::json json = {{"scene_hash", task.scene_hash},
                           {"width", task.width},
                           {"height", task.height},
                           {"method", task.method},
                           {"method_version", task.method_version},
                           {"parameters", parameters_to_json(task.parameters)},
                           {"budget", budget_to_json(task.budget)},
                           {"seed", task.seed}};
    if (task.snapshots) {
        json["snapshots"] = {{"first", task.snapshots->first}, {"factor", task.snapshots->factor}};
    }
    return json;
}

}  // namespace

std::string task_id(const Task& task) {
    return sha256_hex(identity_to_json(task).dump()).substr(0, 32);
}

nlohmann::json task_to_json(const Task& task) {
    nlohmann::json json = identity_to_json(task);
    json["scene"] = task.scene;
    json["scene_file"] = task.scene_file;
    return json;
}

Task task_from_json(const nlohmann::json& json) {
    try {
        Task task{.scene_hash = json.at("scene_hash"),
                  .width = json.at("width"),
                  .height = json.at("height"),
                  .method = json.at("method"),
                  .method_version = json.at("method_version"),
                  .parameters = parameters_from_json(json.at("parameters")),
                  .budget = budget_from_json(json.at("budget")),
                  .seed = json.at("seed"),
                  .scene = json.at("scene"),
                  .scene_file = json.at("scene_file")};
        if (const auto ladder = json.find("snapshots"); ladder != json.end()) {
            task.snapshots = {.first = ladder->at("first"), .factor = ladder->at("factor")};
        }
        return task;
    } catch (const nlohmann::json::exception& e) {
        throw Error(Errc::InvalidArgument, std::string("task in JSON: ") + e.what());
    }
}

}  // namespace misbench
