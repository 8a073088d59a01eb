#include "worker/provenance.h"

#include <unistd.h>

#include <array>
#include <fstream>

#include "renderer/base/build_info.h"
#include "renderer/embree/accelerator.h"

namespace misbench {
namespace {

std::string cpu_model() {
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);) {
        if (line.rfind("model name", 0) != 0) continue;
        const std::size_t colon = line.find(": ");
        if (colon != std::string::npos) return line.substr(colon + 2);
    }
    return "unknown";
}

}  // namespace

std::string host_name() {
    std::array<char, 256> name{};
    return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

Provenance this_machine() {
    return {.build_id = build_id(),
            .compiler = build_compiler(),
            .flags = build_flags(),
            .cpu_model = cpu_model(),
            .isa = embree_isa(),
            .host = host_name()};
}

}  // namespace misbench
