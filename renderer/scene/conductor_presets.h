// Refractive indices of conductors, by the names that scene files give them.
#pragma once

#include <string>
#include <string_view>

#include "renderer/math/vec.h"

namespace misbench {

struct ConductorPreset {
    std::string_view name;
    Rgb eta;  // refractive index
    Rgb k;    // extinction
};

// Throws ParameterError("material", …) that names all presets.
const ConductorPreset& find_conductor_preset(const std::string& name);

}  // namespace misbench
