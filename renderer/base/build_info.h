// Which program this is: stored with every run, and compared before a worker is given work.
#pragma once

#include <string>

namespace misbench {

std::string build_id();        // git describe when the build was configured
std::string build_compiler();  // "GNU 12.2.0"
std::string build_flags();     // optimisation flags of this build type

}  // namespace misbench
