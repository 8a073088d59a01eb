// Refractive indices by name, and metals by name.
#pragma once

#include "renderer/scene/mitsuba/context.h"
#include "renderer/scene/mitsuba/object.h"

namespace misbench::mitsuba {

// A number, or the name of a material such as "bk7".
float read_ior(Object& object, const std::string& name, const std::string& fallback);

// Of a metal.
struct ComplexIndex {
    Rgb eta;
    Rgb k;
};
// From `material`, or from `eta` and `k`; over what is outside.
ComplexIndex read_complex_index(Context& context, Object& object);

}  // namespace misbench::mitsuba
