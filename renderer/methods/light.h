#pragma once

#include "renderer/methods/method.h"

namespace misbench {

extern const MethodInfo kLight;

}  // namespace misbench
