// The path tracer.
#pragma once

#include "renderer/methods/method.h"

namespace misbench {

extern const MethodInfo kPath;

}  // namespace misbench
