// What a neighbour on the machine did to this process, read before and after a render.
#pragma once

#include <cstdint>

namespace misbench {

struct Disturbance {
    std::int64_t involuntary_context_switches = 0;  // of this process, since it began
    double steal_seconds = 0;                       // of the whole machine, since it booted
    std::int64_t peak_memory_bytes = 0;             // of this process, since it began or forgot
};

Disturbance read_disturbance();

// Lets the peak begin again from what is in use now, of which what earlier work left over is given
// back. Where the system does not permit it the peak stays that of the process.
void forget_peak_memory();

}  // namespace misbench
