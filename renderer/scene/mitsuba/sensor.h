// The camera and its film.
#pragma once

#include "renderer/scene/mitsuba/context.h"
#include "renderer/scene/mitsuba/object.h"

namespace misbench::mitsuba {

void read_sensor(Context& context, Object& object);

}  // namespace misbench::mitsuba
