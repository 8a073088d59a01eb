#include "coordinator/task_queue.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <set>
#include <utility>

#include "proto/limits.h"
#include "renderer/base/build_info.h"
#include "renderer/base/error.h"
#include "renderer/base/sha256.h"
#include "results/run_directory.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

// How soon a worker without work asks again.
constexpr milliseconds kIdlePause{250};

// A worker may miss two calls before it loses its lease.
milliseconds heartbeat(const LeasePolicy& policy) { return policy.ttl / 3; }

std::int64_t size_of(const fs::path& file) {
    std::error_code none;
    const std::uintmax_t size = fs::file_size(file, none);
    return none ? 0 : static_cast<std::int64_t>(size);
}

void append(const fs::path& file, std::string_view data) {
    errno = 0;
    std::ofstream out(file, std::ios::binary | std::ios::app);
    out.write(data.data(), static_cast<std::streamsize>(data.size()));
    out.flush();
    if (!out) {
        throw Error(Errc::DataLoss, "write '" + file.string() + "': " + std::strerror(errno));
    }
}

}  // namespace

TaskQueue::TaskQueue(Store store, LeasePolicy policy, Time now)
    : store_(std::move(store)), table_(store_.tasks(), policy, now), latest_(now) {}

TaskQueue::Time TaskQueue::advance(Time now) { return latest_ = std::max(latest_, now); }

SubmitResult TaskQueue::submit(const Plan& plan, Time now) {
    const std::scoped_lock lock(mutex_);
    now = advance(now);
    store_.put_experiment(plan);
    // The way of a restart: leases go on, the table is what the store says.
    table_ = LeaseTable(store_.tasks(), table_.policy(), now);
    labels_.clear();
    SubmitResult result;
    for (const auto& [task, label] : labels(plan.experiment)) {
        ++result.tasks;
        const LeaseTable::Entry* entry = table_.find(task);
        if (entry != nullptr && entry->row.state == TaskState::Done) ++result.cached;
    }
    spdlog::info("experiment submitted name={} tasks={} cached={}", plan.experiment, result.tasks,
                 result.cached);
    return result;
}

const TaskQueue::Labels& TaskQueue::labels(const std::string& experiment) {
    const auto known = labels_.find(experiment);
    if (known != labels_.end()) return known->second;
    Labels labels;
    for (const Cell& cell : store_.experiment(experiment).cells) {
        labels.emplace(task_id(cell.task), cell.method);
    }
    return labels_.emplace(experiment, std::move(labels)).first->second;
}

QueueStatus TaskQueue::status(const std::string& experiment, Time now) {
    const std::scoped_lock lock(mutex_);
    now = advance(now);
    expire(now);
    const Labels* wanted = experiment.empty() ? nullptr : &labels(experiment);
    QueueStatus status;
    for (const LeaseTable::Entry& entry : table_.entries()) {
        const TaskRow& row = entry.row;
        std::string method = row.task.method;
        if (wanted != nullptr) {
            const auto label = wanted->find(row.id);
            if (label == wanted->end()) continue;
            method = label->second;
        }
        switch (row.state) {
            case TaskState::Pending:
                ++status.pending;
                break;
            case TaskState::Done:
                ++status.done;
                break;
            case TaskState::Leased:
                ++status.leased;
                status.running.push_back(
                    {.worker = row.worker,
                     .scene = row.task.scene,
                     .method = method,
                     .task = row.id,
                     .seed = row.task.seed,
                     .since = std::chrono::duration_cast<milliseconds>(now - entry.granted)});
                break;
            case TaskState::Failed:
                ++status.failed;
                status.failures.push_back({.task = row.id,
                                           .scene = row.task.scene,
                                           .method = method,
                                           .error = row.error,
                                           .seed = row.task.seed});
                break;
        }
    }
    std::copy_if(
        finished_.begin(), finished_.end(), std::back_inserter(status.finished),
        [&](const std::string& task) { return wanted == nullptr || wanted->count(task) > 0; });
    return status;
}

void TaskQueue::save(const std::string& task) { store_.save_task_state(table_.find(task)->row); }

void TaskQueue::expire(Time now) {
    for (const std::string& task : table_.expire(now)) {
        const TaskRow& row = table_.find(task)->row;
        spdlog::warn("lease expired task={} worker={} epoch={} losses={}", task, row.worker,
                     row.epoch, row.losses);
        save(task);
    }
}

Renewal TaskQueue::renew(const LeaseRef& lease, Time now) {
    const Renewal renewal = table_.renew(lease, now);
    if (renewal == Renewal::Revived) {
        spdlog::info("lease revived task={} epoch={}", lease.task, lease.epoch);
        save(lease.task);
    }
    return renewal;
}

Instruction TaskQueue::synchronize(const std::string& worker, const std::string& build,
                                   const WorkerReport& report, Time now) {
    if (build != build_id()) {
        throw Error(Errc::FailedPrecondition, "admit worker '" + worker + "': its build is '" +
                                                  build + "'; the coordinator's is '" + build_id() +
                                                  "'");
    }
    const std::scoped_lock lock(mutex_);
    now = advance(now);
    expire(now);
    if (const auto* working = std::get_if<WorkerReport::Working>(&report.doing)) {
        if (renew(working->lease, now) == Renewal::Lost) {
            return {.next = Instruction::Stop{working->lease}};
        }
        return {.next = Instruction::GoOn{working->lease},
                .call_again_in = heartbeat(table_.policy())};
    }
    if (const auto* failed = std::get_if<WorkerReport::Failed>(&report.doing)) {
        if (table_.fail(failed->lease, failed->error, now)) {
            spdlog::warn("task failed task={} worker={} error={}", failed->lease.task, worker,
                         failed->error);
            save(failed->lease.task);
        }
    }
    if (const auto* released = std::get_if<WorkerReport::Released>(&report.doing)) {
        if (table_.release(released->lease, now)) {
            spdlog::info("lease released task={} worker={}", released->lease.task, worker);
            save(released->lease.task);
        }
    }
    if (report.leaving) {
        table_.depart(worker);
        return {.next = Instruction::Exit{}};
    }
    return next_for(worker, now);
}

Instruction TaskQueue::next_for(const std::string& worker, Time now) {
    const auto lease = table_.acquire(worker, now, [this] { return store_.next_epoch(); });
    if (!lease) return {.next = Instruction::Wait{}, .call_again_in = kIdlePause};
    try {
        save(lease->task);
    } catch (...) {
        table_.release(*lease, now);
        throw;
    }
    spdlog::info("lease granted task={} worker={} epoch={} ttl_ms={}", lease->task, worker,
                 lease->epoch, table_.policy().ttl.count());
    return {.next = Instruction::Begin{*lease, table_.find(lease->task)->row.task},
            .call_again_in = heartbeat(table_.policy())};
}

// --- results ---------------------------------------------------------------------------------

const fs::path& TaskQueue::folder_of(const LeaseRef& lease) {
    Upload& upload = uploads_[lease.task];
    if (upload.epoch != lease.epoch) {
        if (!upload.folder.empty()) fs::remove_all(upload.folder);
        upload = {.epoch = lease.epoch, .folder = store_.stage(lease.task, lease.epoch)};
    }
    return upload.folder;
}

void TaskQueue::forget_upload(const std::string& task) {
    const auto found = uploads_.find(task);
    if (found == uploads_.end()) return;
    std::error_code ignored;  // The store empties its incoming folder when it is opened again.
    fs::remove_all(found->second.folder, ignored);
    uploads_.erase(found);
}

std::int64_t TaskQueue::upload(const LeaseRef& lease, const std::string& file, std::int64_t offset,
                               std::string_view data, Time now) {
    const std::scoped_lock lock(mutex_);
    now = advance(now);
    if (table_.standing(lease) != CommitOutcome::Accepted) {
        throw Error(Errc::FailedPrecondition, "upload '" + file + "' of task " + lease.task +
                                                  ": the lease of epoch " +
                                                  std::to_string(lease.epoch) + " is lost");
    }
    renew(lease, now);
    const fs::path path = folder_of(lease) / file;
    if (size_of(path) == offset) append(path, data);
    return size_of(path);
}

void TaskQueue::verify(const LeaseRef& lease, const std::vector<QueueClient::Artefact>& artefacts,
                       const fs::path& folder) const {
    const std::string attempt = "commit task " + lease.task + ": ";
    std::set<std::string> announced;
    for (const QueueClient::Artefact& artefact : artefacts) {
        const fs::path path = folder / artefact.file;
        if (!fs::exists(path)) {
            throw Error(Errc::DataLoss, attempt + artefact.file + " was not uploaded");
        }
        if (size_of(path) != artefact.size || sha256_hex(read_file(path)) != artefact.sha256) {
            throw Error(Errc::DataLoss, attempt + artefact.file + " arrived damaged");
        }
        announced.insert(artefact.file);
    }
    std::set<std::string> wanted(kArtefactNames.begin(), kArtefactNames.end());
    if (!std::ranges::includes(announced, wanted)) {
        throw Error(Errc::InvalidArgument, attempt + "incomplete; wanted: image.exr record.json");
    }
    const Record record = read_record(folder);
    if (record.run != lease.task) {
        throw Error(Errc::InvalidArgument, attempt + "the record is of run " + record.run);
    }
    for (const SnapshotRecord& snapshot : record.snapshots) {
        wanted.insert(snapshot_file(snapshot.statistics.samples));
    }
    if (announced != wanted) {
        throw Error(Errc::InvalidArgument,
                    attempt + "its snapshots are not those that its record names");
    }
}

CommitOutcome TaskQueue::commit(const LeaseRef& lease,
                                const std::vector<QueueClient::Artefact>& artefacts, Time now) {
    const std::scoped_lock lock(mutex_);
    now = advance(now);
    if (const CommitOutcome standing = table_.standing(lease);
        standing != CommitOutcome::Accepted) {
        spdlog::warn("commit refused task={} epoch={} reason={}", lease.task, lease.epoch,
                     standing == CommitOutcome::Stale ? "stale" : "done");
        return standing;
    }
    const fs::path folder = folder_of(lease);
    try {
        verify(lease, artefacts, folder);
    } catch (const Error&) {
        forget_upload(lease.task);
        throw;
    }
    const Recorded recorded = store_.commit_run(folder);
    uploads_.erase(lease.task);
    table_.complete(lease, now);
    finished_.push_back(lease.task);
    spdlog::info("run committed task={} epoch={}", lease.task, lease.epoch);
    return recorded == Recorded::New ? CommitOutcome::Accepted : CommitOutcome::AlreadyDone;
}

}  // namespace misbench
