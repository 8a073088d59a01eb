#pragma once

#include "renderer/methods/method.h"

namespace misbench {

extern const MethodInfo kBdpt;

}  // namespace misbench
