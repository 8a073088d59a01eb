// Profiles of an experiment file: the same experiment at several sizes, as in one for a laptop and
// one for a paper.
#pragma once

#include <string>
#include <vector>

#include "experiments/plan/yaml_reader.h"

namespace misbench {

struct ChosenProfile {
    std::string name;                // "" where the file has no profiles
    std::vector<std::string> known;  // as in the file
};

// Puts what the profile `name` ("" the first) overrides in the place of what the file says: maps
// are merged key by key, lists and single values are replaced. Takes `profiles` out of the tree. A
// profile but the first adds its name to the experiment's, so that all can be in one store. Values
// keep the place where they were written. Throws InvalidArgument with the names of all profiles.
ChosenProfile apply_profile(YamlNode& root, const std::string& name);

}  // namespace misbench
