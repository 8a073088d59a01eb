// misbench report: the experiment as one HTML file.
#include "experiments/report/report.h"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <set>
#include <thread>

#include "experiments/cli/output.h"
#include "experiments/cli/verbs.h"
#include "renderer/base/files.h"

namespace misbench {
namespace {

constexpr std::size_t kLargeReport = 500'000'000;  // bytes

// What a report of the plan depends on, as far as it grows while the plan is run.
struct Progress {
    Plan plan;
    std::size_t n_tasks = 0;
    std::size_t n_done = 0;
    std::size_t n_failed = 0;

    bool is_finished() const { return n_done + n_failed == n_tasks; }
    bool operator==(const Progress&) const = default;
};

Progress progress_of(const Store& store, const std::string& experiment) {
    Progress progress{.plan = store.experiment(experiment)};
    std::set<std::string> ids;
    for (const Cell& cell : progress.plan.cells) ids.insert(task_id(cell.task));
    progress.n_tasks = ids.size();
    for (const std::string& id : ids) {
        const std::optional<TaskRow> row = store.task(id);
        if (store.has_run(id)) {
            ++progress.n_done;
        } else if (row && row->state == TaskState::Failed) {
            ++progress.n_failed;
        }
    }
    return progress;
}

constexpr int kMostTries = 3;

// Whoever runs an experiment measures its runs after the last one: until then we do. A run that
// comes in meanwhile would look as if it could not be measured, so it is looked at once more.
Report measured_report(Store& store, const Plan& plan, const ReportContents& contents) {
    store.measure_in_memory(plan);
    Report report = make_report(store, plan, contents);
    for (int tries = 1; tries < kMostTries && store.measure_in_memory(plan) > 0; ++tries) {
        report = make_report(store, plan, contents);
    }
    return report;
}

void write_report(Store& store, const Plan& plan, const ReportOptions& options,
                  const std::optional<Running>& running) {
    const std::filesystem::path output = options.output.empty()
                                             ? store.folder() / "report.html"
                                             : std::filesystem::path(options.output);
    const Report report =
        measured_report(store, plan,
                        {.seeds = seed_images_from_string(options.seeds),
                         .precision = options.full_precision ? Precision::Float : Precision::Half,
                         .running = running});
    write_file_durably(output, report.html);
    print_note(fmt::format(
        "wrote {}: {:.1f} MB, {} image{}{}", output.string(),
        static_cast<double>(report.html.size()) / 1e6, report.n_images,
        report.n_images == 1 ? "" : "s",
        running ? fmt::format("; {} of {} tasks done", running->n_done, running->n_tasks) : ""));
    if (report.html.size() > kLargeReport && options.seeds != "none" && !running) {
        print_note("--seeds none would leave out all images but the means");
    }
}

// Being finished has to hold for two looks in turn: whoever runs the experiment may go on with
// further seeds.
int watch(const ReportOptions& options) {
    std::optional<Store> store;
    std::optional<Progress> last;
    while (true) {
        if (!store || store->is_outdated()) store.emplace(options.store, Store::Access::ReadOnly);
        Progress progress = progress_of(*store, options.experiment);
        const bool is_same = progress == last;
        if (is_same && progress.is_finished()) {
            write_report(*store, progress.plan, options, std::nullopt);
            return 0;
        }
        if (!is_same) {
            write_report(*store, progress.plan, options,
                         Running{.n_tasks = progress.n_tasks,
                                 .n_done = progress.n_done,
                                 .n_failed = progress.n_failed,
                                 .reload_seconds = options.interval_seconds});
        }
        last = std::move(progress);
        std::this_thread::sleep_for(std::chrono::duration<double>(options.interval_seconds));
    }
}

}  // namespace

int report_verb(const ReportOptions& options) {
    if (options.watch) return watch(options);
    Store store(options.store, Store::Access::ReadOnly);
    write_report(store, store.experiment(options.experiment), options, std::nullopt);
    return 0;
}

}  // namespace misbench
