// A worker's conversation with the coordinator: asks for a task, has it done while a second thread
// keeps the lease alive, delivers the result, and asks again. A coordinator that is away is waited
// for with the finished result in hand. What the outside world does is given as functions, so that
// a test can play coordinator, renderer and time.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <variant>
#include <vector>

#include "proto/client.h"

namespace misbench {

// What became of a task that was begun.
struct TaskFinished {
    std::filesystem::path folder;  // with image.exr, its snapshots and record.json
};
struct TaskFailed {
    std::string error;  // one line
};
struct TaskAbandoned {};
using TaskOutcome = std::variant<TaskFinished, TaskFailed, TaskAbandoned>;

struct SessionLinks {
    // The three calls of the protocol; they throw Error as QueueClient does.
    std::function<Instruction(const WorkerReport&)> synchronize;
    std::function<void(const LeaseRef&, const std::string& file, const std::string& bytes)> upload;
    std::function<CommitOutcome(const LeaseRef&, const std::vector<QueueClient::Artefact>&)> commit;
    // Does a task. Polls `abandon` and never throws.
    std::function<TaskOutcome(const LeaseRef&, const Task&, const std::function<bool()>& abandon)>
        run;
    std::function<std::chrono::steady_clock::time_point()> now;
    // Sleeps so long, or until asked to stop.
    std::function<void(std::chrono::milliseconds, std::stop_token)> pause;
};

class Session {
 public:
    // `patience` is how long to wait for a coordinator that does not answer.
    Session(SessionLinks links, std::chrono::milliseconds patience);

    // Returns when told to leave, by the coordinator or by `stop`; then the task in hand is given
    // back. Throws Unavailable when patience has ended, and what the coordinator answers to a
    // worker that it does not want.
    void run(std::stop_token stop);

 private:
    class Backoff;

    std::optional<Instruction> synchronize(const WorkerReport& report, const std::stop_token& stop);
    WorkerReport work(const Instruction::Begin& begin, const std::stop_token& stop);
    TaskOutcome run_with_heartbeat(const Instruction::Begin& begin, const std::stop_token& stop);
    void keep_alive(const LeaseRef& lease, std::stop_source& lost, const std::stop_token& done);
    WorkerReport deliver(const LeaseRef& lease, const std::filesystem::path& folder,
                         const std::stop_token& stop);
    CommitOutcome send(const LeaseRef& lease, const std::filesystem::path& folder, bool& uploaded);

    SessionLinks links_;
    std::chrono::milliseconds patience_;
    std::chrono::milliseconds heartbeat_{0};  // between two calls while a task is done
};

}  // namespace misbench
