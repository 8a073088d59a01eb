#include "experiments/report/provenance.h"

#include <fmt/format.h>

#include <algorithm>

namespace misbench {

std::vector<Origin> origins(const Store& store, const Plan& plan) {
    std::vector<Origin> found;
    for (const Cell& cell : plan.cells) {
        if (cell.role != Role::Test) continue;
        const std::optional<Record> record = store.run(task_id(cell.task));
        if (!record) continue;
        const auto same = [&record](const Origin& origin) {
            return origin.provenance == record->provenance &&
                   origin.threads == record->statistics.threads;
        };
        auto origin = std::ranges::find_if(found, same);
        if (origin == found.end()) {
            found.push_back({record->provenance, record->statistics.threads, 0});
            origin = found.end() - 1;
        }
        ++origin->n_runs;
    }
    return found;
}

std::vector<std::string> provenance_lines(const std::vector<Origin>& origins) {
    std::vector<std::string> lines;
    for (const auto& [from, threads, n_runs] : origins) {
        if (from.cpu_model.empty()) {
            lines.push_back(
                fmt::format("imported images; renderer: {}: {} runs", from.build_id, n_runs));
            continue;
        }
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

std::vector<std::string> provenance_lines(const Store& store, const Plan& plan) {
    std::vector<std::string> lines = provenance_lines(origins(store, plan));
    for (const Cell& a : plan.cells) {
        const bool is_both = std::ranges::any_of(plan.cells, [&a](const Cell& b) {
            return a.role == Role::ReferenceA && b.role == Role::ReferenceB && a.task == b.task;
        });
        if (!is_both) continue;
        lines.push_back(
            fmt::format("{}: a single reference image, whose noise and bias count as "
                        "error of all methods",
                        a.scene));
    }
    return lines;
}

}  // namespace misbench
