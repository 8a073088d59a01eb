// Direct light only, by any number of samples of each technique.
#pragma once

#include "renderer/methods/method.h"

namespace misbench {

extern const MethodInfo kDirect;

}  // namespace misbench
