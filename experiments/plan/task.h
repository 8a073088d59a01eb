// A task: one render that an experiment asks for, complete enough for any worker to do it. Its id
// names the work and nothing else, so a finished run is found again by whoever asks for the same.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "renderer/base/budget.h"
#include "renderer/base/parameters.h"
#include "renderer/base/snapshots.h"

namespace misbench {

struct Task {
    // What the id is made of.
    std::string scene_hash;  // SHA-256 of the scene's content
    int width = 0;           // pixels
    int height = 0;
    std::string method;       // a row of the catalogue, not the user's label
    int method_version = 0;   // bumped when the method's behaviour changes
    ParameterMap parameters;  // effective: defaults filled in
    Budget budget;
    std::int64_t seed = 0;
    // Asked for beside the image. Part of the id only where they are, so that a run without them
    // does not stand for one with them.
    std::optional<SnapshotLadder> snapshots = {};

    // What it takes to do it here, not part of the id.
    std::string scene;       // the scene's name
    std::string scene_file;  // where a worker finds it

    bool operator==(const Task&) const = default;
};

// The first 32 hexadecimal digits of the SHA-256 of the canonical JSON of the identity. A run has
// the id of its task.
std::string task_id(const Task& task);

nlohmann::json task_to_json(const Task& task);
Task task_from_json(const nlohmann::json& json);  // throws InvalidArgument

}  // namespace misbench
