// The facts of a scene as `misbench scene` prints them.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "renderer/scene/inspect.h"

namespace misbench {

nlohmann::ordered_json facts_to_json(const SceneListing& listing, const LoadedScene& loaded,
                                     const SceneFacts& facts);
std::string facts_to_text(const SceneListing& listing, const LoadedScene& loaded,
                          const SceneFacts& facts);

// "diffuse 5, generic 1": the types of materials or lights.
std::string material_types(const SceneFacts& facts);
std::string light_types(const SceneFacts& facts);
// "textures quadrics", or "none".
std::string feature_list(const Scene& scene);

}  // namespace misbench
