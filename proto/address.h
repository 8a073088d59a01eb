// Where a coordinator listens: "unix:/path" or "host:port".
#pragma once

#include <string>

namespace misbench {

// Throws InvalidArgument for what gRPC would wrap, cut or wait for without a word. `attempt` begins
// the message: "connect to", "listen on".
void check_address(const std::string& attempt, const std::string& address);

bool is_unix_address(const std::string& address);
std::string unix_path(const std::string& address);  // REQUIRES: is_unix_address

// Only this machine can reach it: a unix socket or a loopback address. REQUIRES: checked.
bool is_local_address(const std::string& address);

}  // namespace misbench
