#include "renderer/methods/disturbance.h"

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#include <string>

namespace misbench {

Disturbance read_disturbance() {
    Disturbance result;
    rusage usage{};
    if (::getrusage(RUSAGE_SELF, &usage) == 0) {
        result.involuntary_context_switches = usage.ru_nivcsw;
        result.peak_memory_bytes = usage.ru_maxrss * 1024;
    }
    // First line of /proc/stat: cpu user nice system idle iowait irq softirq steal, in ticks.
    std::ifstream stat("/proc/stat");
    std::string name;
    double ticks = 0;
    stat >> name;
    for (int field = 0; field < 8; ++field) stat >> ticks;
    if (stat) result.steal_seconds = ticks / static_cast<double>(::sysconf(_SC_CLK_TCK));
    return result;
}

void forget_peak_memory() {
    ::malloc_trim(0);
    std::ofstream("/proc/self/clear_refs") << 5;  // proc(5): resets the peak resident set size
}

}  // namespace misbench
