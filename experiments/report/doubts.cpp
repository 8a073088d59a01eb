#include "experiments/report/doubts.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "experiments/report/table.h"

namespace misbench {
namespace {

std::string place_of(const std::string& scene, const std::string& method, const Budget& budget) {
    return fmt::format("{}, {}, {}", scene, method, to_string(budget));
}

class Doubter {
 public:
    Doubter(const Store& store, const Plan& plan, const Comparison& comparison)
        : store_(store), plan_(plan), comparison_(comparison) {}

    std::vector<Doubt> all() const {
        std::vector<Doubt> found{
            {"tasks that failed", failed()},
            {"invalid runs, left out of all numbers", invalid()},
            {"cells without all of their seeds", incomplete()},
            {few_passes_footnote(), cells_with(&ComparedCell::few_passes)},
            {heavy_tail_footnote(), tails(TailVerdict::Heavy)},
            {"no interval: " + to_string(NoInterval::HeavyTail), tails(TailVerdict::Dishonest)},
            {"ratios of which only one interval excludes 1, log-delta-t's or the bootstrap-t's",
             disputed_ratios()},
            {noisy_reference_footnote(), noisy_references()},
            {"references of fewer samples than a run they judge", small_references()},
            {fmt::format("runs of which a hypervisor stole more than {:.0f} %", 100 * kMuchSteal),
             stolen()}};
        std::erase_if(found, [](const Doubt& doubt) { return doubt.cases.empty(); });
        return found;
    }

 private:
    std::vector<std::string> failed() const {
        std::vector<std::string> cases;
        for (const Cell& cell : plan_.cells) {
            const std::optional<TaskRow> row = store_.task(task_id(cell.task));
            if (!row || row->state != TaskState::Failed) continue;
            cases.push_back(fmt::format("{}, seed {}: {}",
                                        place_of(cell.scene, cell.method, cell.budget), cell.seed,
                                        row->error));
        }
        return cases;
    }

    std::vector<std::string> invalid() const {
        std::vector<std::string> cases;
        for (const Cell& cell : plan_.cells) {
            const std::optional<Record> record = store_.run(task_id(cell.task));
            if (!record || record->valid) continue;
            const RenderStatistics& run = record->statistics;
            const bool is_empty = run.passes == 0 && run.nonfinite_samples == 0;
            cases.push_back(
                fmt::format("{}, seed {}, run {}: {}",
                            place_of(cell.scene, cell.method, cell.budget), cell.seed, record->run,
                            is_empty ? "no pass ended within its budget"
                                     : fmt::format("{} non-finite and {} negative samples",
                                                   run.nonfinite_samples, run.negative_samples)));
        }
        return cases;
    }

    std::vector<std::string> incomplete() const {
        std::vector<std::string> cases;
        for (const ComparedCell& cell : comparison_.cells) {
            if (cell.is_complete()) continue;
            cases.push_back(place_of(cell.scene, cell.method, cell.budget) + ": " +
                            status_of(cell));
        }
        return cases;
    }

    std::vector<std::string> cells_with(bool ComparedCell::*flag) const {
        std::vector<std::string> cases;
        for (const ComparedCell& cell : comparison_.cells) {
            if (cell.*flag) cases.push_back(place_of(cell.scene, cell.method, cell.budget));
        }
        return cases;
    }

    std::vector<std::string> tails(TailVerdict verdict) const {
        std::vector<std::string> cases;
        for (const ComparedCell& cell : comparison_.cells) {
            if (cell.tail_verdict != verdict) continue;
            cases.push_back(place_of(cell.scene, cell.method, cell.budget));
            if (!cell.tail) continue;
            cases.back() += fmt::format(": the largest is {:.3g} times the median", *cell.tail);
        }
        return cases;
    }

    std::vector<std::string> disputed_ratios() const {
        std::vector<std::string> cases;
        for (const ComparedCell& cell : comparison_.cells) {
            if (!cell.ratio || !cell.ratio->interval) continue;
            const ComparedCell* baseline =
                comparison_.find(cell.scene, comparison_.baseline, cell.budget);
            if (baseline == nullptr) continue;  // a mean over scenes, or a ratio to the best
            const std::optional<Estimate> check = bootstrap_ratio(cell, *baseline);
            if (!check || !check->interval || excludes_one(*check) == cell.ratio_excludes_one()) {
                continue;
            }
            const auto shown = [](const Interval& i) {
                return fmt::format("[{:.4g}, {:.4g}]", i.low, i.high);
            };
            cases.push_back(fmt::format(
                "{}: ×{:.4g} {}, bootstrap-t {}", place_of(cell.scene, cell.method, cell.budget),
                cell.ratio->value, shown(*cell.ratio->interval), shown(*check->interval)));
        }
        return cases;
    }

    std::vector<std::string> noisy_references() const {
        std::vector<std::string> cases;
        for (const ComparedCell& cell : comparison_.cells) {
            if (!cell.has_noisy_reference()) continue;
            cases.push_back(fmt::format("{}: {:.2g} %",
                                        place_of(cell.scene, cell.method, cell.budget),
                                        100 * *cell.reference_share));
        }
        return cases;
    }

    std::vector<std::string> small_references() const {
        const std::map<std::string, RunSummary> runs = store_.run_summaries();
        std::map<std::string, std::int64_t> of_reference;
        std::map<std::string, std::int64_t> of_tests;
        for (const Cell& cell : plan_.cells) {
            const auto run = runs.find(task_id(cell.task));
            if (run == runs.end()) continue;
            const std::int64_t passes = run->second.passes;
            if (cell.role != Role::Test) {
                of_reference[cell.scene] += passes;
            } else {
                of_tests[cell.scene] = std::max(of_tests[cell.scene], passes);
            }
        }
        std::vector<std::string> cases;
        for (const auto& [scene, passes] : of_reference) {
            const bool is_unknown = passes == 0;  // of imported images
            if (is_unknown || passes >= of_tests[scene]) continue;
            cases.push_back(
                fmt::format("{}: {} spp, and a run has {}", scene, passes, of_tests[scene]));
        }
        return cases;
    }

    std::vector<std::string> stolen() const {
        std::vector<std::string> cases;
        for (const Cell& cell : plan_.cells) {
            if (cell.role != Role::Test) continue;
            const std::optional<Record> record = store_.run(task_id(cell.task));
            if (!record) continue;
            const RenderStatistics& run = record->statistics;
            if (run.steal_seconds <= kMuchSteal * run.cpu_seconds) continue;
            cases.push_back(fmt::format("{}, seed {}: {:.3g} s of {:.3g} s",
                                        place_of(cell.scene, cell.method, cell.budget), cell.seed,
                                        run.steal_seconds, run.cpu_seconds));
        }
        return cases;
    }

    const Store& store_;
    const Plan& plan_;
    const Comparison& comparison_;
};

}  // namespace

std::vector<Doubt> doubts(const Store& store, const Plan& plan, const Comparison& comparison) {
    return Doubter(store, plan, comparison).all();
}

std::vector<std::string> disturbance_lines(const Store& store, const Plan& plan) {
    std::set<std::string> seen;
    double cpu_seconds = 0;
    double steal_seconds = 0;
    std::int64_t switches = 0;
    double most_switches = 0;  // a CPU second
    for (const Cell& cell : plan.cells) {
        const std::string id = task_id(cell.task);
        if (cell.role != Role::Test || !seen.insert(id).second) continue;
        const std::optional<Record> record = store.run(id);
        if (!record || record->statistics.cpu_seconds <= 0) continue;
        const RenderStatistics& run = record->statistics;
        cpu_seconds += run.cpu_seconds;
        steal_seconds += run.steal_seconds;
        switches += run.involuntary_context_switches;
        most_switches = std::max(
            most_switches, static_cast<double>(run.involuntary_context_switches) / run.cpu_seconds);
    }
    if (cpu_seconds <= 0) return {};
    return {fmt::format("{} involuntary context switches in {:.4g} CPU seconds, {:.3g} a second; "
                        "{:.3g} in the run with most",
                        switches, cpu_seconds, static_cast<double>(switches) / cpu_seconds,
                        most_switches),
            fmt::format("{:.3g} s stolen by a hypervisor while they ran, of the whole machine",
                        steal_seconds)};
}

}  // namespace misbench
