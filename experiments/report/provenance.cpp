#include "experiments/report/provenance.h"

#include <fmt/format.h>

namespace misbench {

std::vector<std::string> provenance_lines(const std::vector<Origin>& origins) {
    std::vector<std::string> lines;
    for (const auto& [from, threads, n_runs] : origins) {
        lines.push_back(
            fmt::format("machine: {} ({}, {}), {} thread{} a run; build {}, {}: {} runs",
                        from.cpu_model, from.isa, from.host, threads, threads == 1 ? "" : "s",
                        from.build_id, from.compiler, n_runs));
    }
    if (origins.size() > 1) {
        lines.emplace_back(
            "runs of several machines, thread counts or builds: compare their times "
            "with care");
    }
    return lines;
}

}  // namespace misbench
