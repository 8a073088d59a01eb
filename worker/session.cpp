#include "worker/session.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <thread>
#include <utility>

#include "proto/limits.h"
#include "renderer/base/error.h"
#include "renderer/base/files.h"
#include "renderer/base/sha256.h"
#include "renderer/base/snapshots.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr milliseconds kFirstPause{100};
constexpr milliseconds kLastPause{5000};
// A coordinator that asks for the same task at once is not asked in a busy loop.
constexpr milliseconds kShortestPause{10};
// Deliveries that arrive damaged, or that the store cannot write, before the task counts as failed.
constexpr int kMaxDamagedDeliveries = 3;

}  // namespace

// Longer and longer pauses between tries, until patience ends.
class Session::Backoff {
 public:
    explicit Backoff(const Session& session) : session_(session), since_(session.links_.now()) {}

    // Pauses before the next try, or throws `error` once more.
    void pause_or_throw(const Error& error, const std::stop_token& stop) {
        const auto waited = session_.links_.now() - since_;
        if (waited >= session_.patience_) throw error;
        spdlog::warn("coordinator away error={} next_try_ms={}", error.what(), pause_.count());
        session_.links_.pause(pause_, stop);
        pause_ = std::min(2 * pause_, kLastPause);
    }

 private:
    const Session& session_;
    std::chrono::steady_clock::time_point since_;
    milliseconds pause_ = kFirstPause;
};

Session::Session(SessionLinks links, milliseconds patience)
    : links_(std::move(links)), patience_(patience) {}

void Session::run(std::stop_token stop) {
    WorkerReport report;
    while (true) {
        report.leaving = stop.stop_requested();
        const std::optional<Instruction> answer = synchronize(report, stop);
        if (!answer || std::holds_alternative<Instruction::Exit>(answer->next)) return;
        if (const auto* begin = std::get_if<Instruction::Begin>(&answer->next)) {
            heartbeat_ = answer->call_again_in;
            report = work(*begin, stop);
        } else {
            links_.pause(std::max(answer->call_again_in, kShortestPause), stop);
            report = {};
        }
    }
}

// No answer: we are asked to stop and the coordinator is away. It will miss us soon enough.
std::optional<Instruction> Session::synchronize(const WorkerReport& report,
                                                const std::stop_token& stop) {
    Backoff backoff(*this);
    while (true) {
        try {
            return links_.synchronize(report);
        } catch (const Error& error) {
            if (error.code() != Errc::Unavailable) throw;
            if (stop.stop_requested()) return std::nullopt;
            backoff.pause_or_throw(error, stop);
        }
    }
}

WorkerReport Session::work(const Instruction::Begin& begin, const std::stop_token& stop) {
    spdlog::info("task begun task={} epoch={} scene={} method={} seed={}", begin.lease.task,
                 begin.lease.epoch, begin.task.scene, begin.task.method, begin.task.seed);
    const TaskOutcome outcome = run_with_heartbeat(begin, stop);
    if (const auto* finished = std::get_if<TaskFinished>(&outcome)) {
        return deliver(begin.lease, finished->folder, stop);
    }
    if (const auto* failed = std::get_if<TaskFailed>(&outcome)) {
        spdlog::warn("task failed task={} error={}", begin.lease.task, failed->error);
        return {.doing = WorkerReport::Failed{begin.lease, failed->error}};
    }
    spdlog::info("task abandoned task={} epoch={}", begin.lease.task, begin.lease.epoch);
    // Giving back a lease that was lost changes nothing.
    return {.doing = WorkerReport::Released{begin.lease}};
}

TaskOutcome Session::run_with_heartbeat(const Instruction::Begin& begin,
                                        const std::stop_token& stop) {
    std::stop_source lost;
    const std::jthread heart(
        [&](const std::stop_token& done) { keep_alive(begin.lease, lost, done); });
    return links_.run(begin.lease, begin.task,
                      [&] { return stop.stop_requested() || lost.stop_requested(); });
}

// Nothing that goes wrong here ends the task: whether the result is wanted is decided when it is
// delivered.
void Session::keep_alive(const LeaseRef& lease, std::stop_source& lost,
                         const std::stop_token& done) {
    milliseconds pause = heartbeat_;
    while (true) {
        links_.pause(std::max(pause, kShortestPause), done);
        if (done.stop_requested()) return;
        try {
            const Instruction answer = links_.synchronize({.doing = WorkerReport::Working{lease}});
            pause = answer.call_again_in;
            if (!std::holds_alternative<Instruction::Stop>(answer.next)) continue;
            spdlog::warn("lease lost task={} epoch={}", lease.task, lease.epoch);
            lost.request_stop();
            return;
        } catch (const Error& error) {
            spdlog::warn("lease not renewed task={} error={}", lease.task, error.what());
            pause = std::min(heartbeat_, kLastPause);
        }
    }
}

WorkerReport Session::deliver(const LeaseRef& lease, const fs::path& folder,
                              const std::stop_token& stop) {
    struct Scratch {
        fs::path folder;
        ~Scratch() {
            std::error_code ignored;
            fs::remove_all(folder, ignored);
        }
    } const scratch{folder};
    Backoff backoff(*this);
    bool uploaded = false;
    int damaged = 0;
    while (true) {
        try {
            const CommitOutcome outcome = send(lease, folder, uploaded);
            spdlog::info("result {} task={} epoch={}",
                         outcome == CommitOutcome::Stale ? "dropped" : "delivered", lease.task,
                         lease.epoch);
            return {};
        } catch (const Error& error) {
            switch (error.code()) {
                case Errc::FailedPrecondition:
                    spdlog::warn("result dropped task={} error={}", lease.task, error.what());
                    return {};
                case Errc::DataLoss:
                    uploaded = false;
                    if (++damaged < kMaxDamagedDeliveries) continue;
                    return {.doing = WorkerReport::Failed{lease, error.what()}};
                case Errc::Unavailable:
                    if (stop.stop_requested()) return {.doing = WorkerReport::Released{lease}};
                    backoff.pause_or_throw(error, stop);
                    continue;
                default:
                    return {.doing = WorkerReport::Failed{lease, error.what()}};
            }
        }
    }
}

CommitOutcome Session::send(const LeaseRef& lease, const fs::path& folder, bool& uploaded) {
    std::vector<QueueClient::Artefact> artefacts;
    std::vector<std::string> files(kArtefactNames.begin(), kArtefactNames.end());
    for (const auto& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (is_snapshot_file(name)) files.push_back(name);
    }
    std::ranges::sort(files);
    for (const std::string& file : files) {
        const std::string bytes = read_file(folder / file);
        if (!uploaded) links_.upload(lease, file, bytes);
        artefacts.push_back({.file = file,
                             .size = static_cast<std::int64_t>(bytes.size()),
                             .sha256 = sha256_hex(bytes)});
    }
    uploaded = true;
    return links_.commit(lease, artefacts);
}

}  // namespace misbench
