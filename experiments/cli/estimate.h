// From the options that say what is estimated to a task and its scene, for verbs that render
// without an experiment.
#pragma once

#include "experiments/cli/verbs.h"
#include "experiments/plan/task.h"
#include "experiments/plan/yaml_reader.h"
#include "renderer/methods/render_loop.h"
#include "renderer/scene/load.h"

namespace misbench {

struct Estimate {
    Task task;
    LoadedScene loaded;
};
// Everything is checked before the scene is loaded. Throws InvalidArgument or NotFound.
Estimate load_estimate(const EstimateOptions& options, const Budget& budget);

RenderRequest request_of(const Task& task, int threads);

// --set KEY=VALUE, several times. Throws InvalidArgument.
ParameterMap parse_parameters(const std::vector<std::string>& assignments);

// Both values of "640x480" or "12,34". Throws InvalidArgument "OPTION TEXT: must be FORM".
std::vector<YamlNode> parse_pair(const std::string& option, const std::string& text, char separator,
                                 const std::string& form);

}  // namespace misbench
