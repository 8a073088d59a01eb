// --set PATH=VALUE: one value of an experiment file, replaced or added before anything is checked.
#pragma once

#include <string>

#include "experiments/plan/yaml_reader.h"

namespace misbench {

// PATH goes by keys from the top, joined by dots: methods.pt.max_depth, image.width, seeds. Into a
// list it goes by number from 0 (budgets.0.samples), and into `scenes` also by scene. VALUE is
// YAML. All but the last key must be there, or be a section of its own (image, reference); whether
// the last one may be there is for the reader of the tree. Throws InvalidArgument with what is
// there.
void apply_override(YamlNode& root, const std::string& assignment);

}  // namespace misbench
