// Where a run was made, for its record.
#pragma once

#include <string>

#include "results/record.h"

namespace misbench {

Provenance this_machine();
std::string host_name();

}  // namespace misbench
