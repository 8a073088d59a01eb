// The renderer's table of contents. Explicit and constant: the linker can drop nothing, and no
// code of ours runs before main().
#pragma once

#include <span>
#include <string>

#include "renderer/methods/method.h"

namespace misbench {

std::span<const MethodInfo> methods();
// Throws ParameterError("method", …) with the list of what is known.
const MethodInfo& find_method(const std::string& name);

}  // namespace misbench
