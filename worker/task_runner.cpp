#include "worker/task_runner.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "renderer/base/error.h"
#include "renderer/base/files.h"
#include "renderer/base/sha256.h"
#include "renderer/base/utc.h"
#include "renderer/image/image.h"
#include "renderer/methods/catalogue.h"
#include "renderer/methods/render_loop.h"
#include "worker/provenance.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;

std::string one_line(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
}

void require_method_version(const Task& task) {
    const int here = find_method(task.method).version;
    if (here == task.method_version) return;
    throw Error(Errc::FailedPrecondition, "render method '" + task.method +
                                              "': the task is for its version " +
                                              std::to_string(task.method_version) +
                                              "; this worker has version " + std::to_string(here));
}

}  // namespace

TaskRunner::TaskRunner(std::string worker, int threads, fs::path scratch)
    : worker_(std::move(worker)),
      threads_(threads),
      scratch_(std::move(scratch)),
      provenance_(this_machine()) {}

TaskOutcome TaskRunner::run(const LeaseRef& lease, const Task& task,
                            const std::function<bool()>& abandon) noexcept {
    try {
        return render_task(lease, task, abandon);
    } catch (const std::exception& error) {
        return TaskFailed{one_line(error.what())};
    }
}

const LoadedScene& TaskRunner::scene_of(const Task& task) {
    if (scene_hash_ == task.scene_hash) return scene_;
    const std::string hash = scene_content_hash(task.scene_file);
    if (hash != task.scene_hash) {
        throw Error(Errc::FailedPrecondition,
                    "load scene '" + task.scene_file +
                        "': it changed since the experiment was planned; its hash is " + hash +
                        ", the task's is " + task.scene_hash);
    }
    scene_hash_.clear();
    scene_ = load_scene(task.scene_file, threads_);
    scene_hash_ = hash;
    return scene_;
}

TaskOutcome TaskRunner::render_task(const LeaseRef& lease, const Task& task,
                                    const std::function<bool()>& abandon) {
    require_method_version(task);
    const LoadedScene& loaded = scene_of(task);
    RenderResult result = render(*loaded.scene, {.method = task.method,
                                                 .parameters = task.parameters,
                                                 .width = task.width,
                                                 .height = task.height,
                                                 .budget = task.budget,
                                                 .seed = task.seed,
                                                 .threads = threads_,
                                                 .abandon = abandon,
                                                 .snapshots = task.snapshots});
    if (result.abandoned) return TaskAbandoned{};
    result.statistics.load_seconds = loaded.load_seconds;
    result.statistics.build_seconds = loaded.build_seconds;

    const fs::path folder = scratch_ / (lease.task + "." + std::to_string(lease.epoch));
    fs::remove_all(folder);
    fs::create_directories(folder);
    // Returns the hash of the file's bytes.
    const auto write = [&](const std::string& file, const Image& image, const Budget& budget) {
        write_exr(folder / file, image,
                  {{"run", lease.task},
                   {"scene", task.scene},
                   {"method", task.method},
                   {"budget", to_string(budget)},
                   {"seed", std::to_string(task.seed)}});
        return sha256_hex(read_file(folder / file));
    };
    std::vector<SnapshotRecord> snapshots;
    for (const auto& [statistics, image] : result.snapshots) {
        const Budget budget = SampleBudget{statistics.samples};
        snapshots.push_back(
            {.statistics = statistics,
             .image_sha256 = write(snapshot_file(statistics.samples), image, budget)});
    }
    const Record record{.run = lease.task,
                        .task = task,
                        .statistics = result.statistics,
                        .valid = result.valid,
                        .description = result.description,
                        .worker = worker_,
                        .epoch = lease.epoch,
                        .finished_at = utc_now(),
                        .provenance = provenance_,
                        .image_sha256 = write("image.exr", result.image, task.budget),
                        .snapshots = std::move(snapshots)};
    write_file_durably(folder / "record.json", record_to_json(record).dump(2) + "\n");
    return TaskFinished{folder};
}

}  // namespace misbench
