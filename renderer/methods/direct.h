// Direct light at the first surface: light samples, which may be resampled, and BSDF samples.
#pragma once

#include "renderer/methods/method.h"

namespace misbench {

extern const MethodInfo kDirect;

}  // namespace misbench
