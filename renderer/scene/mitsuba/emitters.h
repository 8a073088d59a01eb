// Lights that are not surfaces.
#pragma once

#include "renderer/scene/mitsuba/context.h"
#include "renderer/scene/mitsuba/object.h"

namespace misbench::mitsuba {

// Adds an emitter of the top level to the scene.
void read_emitter(Context& context, Object& object);

}  // namespace misbench::mitsuba
