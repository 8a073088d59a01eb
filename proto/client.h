// The client's side of the queue protocol, in our own values: nothing of gRPC or Protobuf shows.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "experiments/plan/experiment.h"

namespace misbench {

struct LeaseRef {
    std::string task;
    std::int64_t epoch = 0;
    bool operator==(const LeaseRef&) const = default;
};

struct QueueStatus {
    struct Running {
        std::string worker, scene, method, task;
        std::int64_t seed = 0;
        std::chrono::milliseconds since{0};
    };
    struct Failed {
        std::string task, scene, method, error;
        std::int64_t seed = 0;
    };
    std::int64_t pending = 0, leased = 0, done = 0, failed = 0;
    std::vector<Running> running;
    std::vector<Failed> failures;
    std::vector<std::string> finished;
};

struct SubmitResult {
    std::int64_t tasks = 0;
    std::int64_t cached = 0;
};

// What a worker reports when it synchronizes.
struct WorkerReport {
    struct Idle {};
    struct Working {
        LeaseRef lease;
    };
    struct Failed {
        LeaseRef lease;
        std::string error;
    };
    struct Released {
        LeaseRef lease;
    };
    std::variant<Idle, Working, Failed, Released> doing;
    bool leaving = false;
};

// What it is told.
struct Instruction {
    struct Begin {
        LeaseRef lease;
        Task task;
    };
    struct GoOn {
        LeaseRef lease;
    };
    struct Stop {
        LeaseRef lease;
    };
    struct Wait {};
    struct Exit {};
    std::variant<Begin, GoOn, Stop, Wait, Exit> next;
    std::chrono::milliseconds call_again_in{0};
};

enum class CommitOutcome { Accepted, Stale, AlreadyDone };

// Every call has a deadline and throws Error: Unavailable when nobody answers in time (calling
// again is safe), otherwise the code and the message of the coordinator's own error.
class QueueClient {
 public:
    // "unix:/path" or "host:port".
    explicit QueueClient(const std::string& address,
                         std::chrono::milliseconds deadline = std::chrono::seconds(10));
    ~QueueClient();
    QueueClient(QueueClient&&) noexcept;

    SubmitResult submit(const Plan& plan);
    QueueStatus status(const std::string& experiment);

    Instruction synchronize(const std::string& worker, const std::string& build_id,
                            const WorkerReport& report);
    // Sends a file in bounded chunks, from where the coordinator says it is.
    void upload(const LeaseRef& lease, const std::string& file, const std::string& bytes);
    struct Artefact {
        std::string file;
        std::int64_t size = 0;
        std::string sha256;
    };
    CommitOutcome commit(const LeaseRef& lease, const std::vector<Artefact>& artefacts);

 private:
    struct Connection;
    std::unique_ptr<Connection> connection_;
};

}  // namespace misbench
