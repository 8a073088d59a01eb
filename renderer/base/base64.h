// Bytes as text, for files that hold other files (RFC 4648, with padding).
#pragma once

#include <string>
#include <string_view>

namespace misbench {

std::string base64(std::string_view bytes);

}  // namespace misbench
