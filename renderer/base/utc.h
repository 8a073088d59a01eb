// The date and time of records.
#pragma once

#include <string>

namespace misbench {

std::string utc_now();  // ISO 8601, to the second

}  // namespace misbench
