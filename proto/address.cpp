#include "proto/address.h"

#include <arpa/inet.h>

#include <charconv>
#include <string_view>

#include "proto/limits.h"
#include "renderer/base/error.h"

namespace misbench {
namespace {

constexpr std::string_view kUnix = "unix:";
constexpr int kMaxPort = 65'535;

bool is_port(std::string_view text) {
    int port = -1;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), port);
    return failure == std::errc() && end == text.data() + text.size() && port >= 0 &&
           port <= kMaxPort;
}

bool has_host_and_port(std::string_view address) {
    const std::size_t colon = address.rfind(':');
    return colon != std::string_view::npos && colon > 0 && is_port(address.substr(colon + 1));
}

}  // namespace

bool is_unix_address(const std::string& address) { return address.rfind(kUnix, 0) == 0; }

std::string unix_path(const std::string& address) { return address.substr(kUnix.size()); }

void check_address(const std::string& attempt, const std::string& address) {
    const auto refuse = [&](const std::string& reason) {
        throw Error(Errc::InvalidArgument, attempt + " '" + address + "': " + reason);
    };
    if (!is_unix_address(address)) {
        if (!has_host_and_port(address)) refuse("no address; wanted: unix:/path or host:port");
        return;
    }
    const std::size_t length = unix_path(address).size();
    if (length == 0 || length > kMaxUnixPathBytes) {
        refuse("the path of a socket has 1 to " + std::to_string(kMaxUnixPathBytes) +
               " bytes, this one " + std::to_string(length));
    }
}

bool is_local_address(const std::string& address) {
    if (is_unix_address(address)) return true;
    const std::string host = address.substr(0, address.rfind(':'));
    in_addr v4{};
    if (::inet_pton(AF_INET, host.c_str(), &v4) == 1) return (ntohl(v4.s_addr) >> 24U) == 127U;
    return host == "localhost" || host == "[::1]";
}

}  // namespace misbench
