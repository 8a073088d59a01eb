// Log lines go to stderr (stdout belongs to the results): one fixed verb phrase, then key=value.
#pragma once

#include <spdlog/spdlog.h>

#include <string>

namespace misbench {

// Makes the default logger of this process. `level` as spdlog names it: debug, info, warn, error.
void init_log(const std::string& program, const std::string& level);

}  // namespace misbench
