// What a neighbour on the machine did to this process, read before and after a render.
#pragma once

#include <cstdint>

namespace misbench {

struct Disturbance {
    std::int64_t involuntary_context_switches = 0;  // of this process, since it began
    double steal_seconds = 0;                       // of the whole machine, since it booted
    std::int64_t peak_memory_bytes = 0;             // of this process, so far
};

Disturbance read_disturbance();

}  // namespace misbench
