#include "experiments/report/provenance.h"

#include <fmt/format.h>

namespace misbench {

std::vector<std::string> provenance_lines(const Store& store, const std::string& experiment) {
    std::vector<std::string> lines;
    const std::vector<Origin> origins = store.origins(experiment);
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
    for (std::string& warning : provenance_warnings(store, experiment)) {
        lines.push_back(std::move(warning));
    }
    return lines;
}

std::vector<std::string> provenance_warnings(const Store& store, const std::string& experiment) {
    std::vector<std::string> lines;
    if (store.origins(experiment).size() > 1) {
        lines.emplace_back(
            "runs of several machines, thread counts or builds: compare their times "
            "with care");
    }
    for (const std::string& scene : store.single_references(experiment)) {
        lines.push_back(
            fmt::format("{}: a single reference image, whose noise and bias count as error of all "
                        "methods",
                        scene));
    }
    return lines;
}

}  // namespace misbench
