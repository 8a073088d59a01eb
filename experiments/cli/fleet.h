// The coordinator and the workers of `misbench run`, as children of this process. All calls come
// from the thread that made the fleet, which therefore outlives every child.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "experiments/cli/child_process.h"

namespace misbench {

struct FleetOptions {
    std::filesystem::path store;
    int workers = 1;
    int threads_per_worker = 1;
};

// How often a child that died is started again, each.
inline constexpr int kMaxRestarts = 5;

class Fleet {
 public:
    // Starts the coordinator. Logs go to STORE/logs.
    explicit Fleet(FleetOptions options);
    ~Fleet();
    Fleet(const Fleet&) = delete;
    Fleet& operator=(const Fleet&) = delete;

    // Where the coordinator listens: a socket in a folder only this user can enter.
    std::string address() const;
    bool is_coordinator_ready() const;
    void start_workers();

    // Starts again what died, and says so, one line each. Throws the coordinator's own error when
    // it ends with one, Unavailable when it died too often.
    std::vector<std::string> tend();
    // False when every worker died too often.
    bool has_workers() const;

    // Asks the workers to end; is_stopped(), called until it is true, then asks the coordinator.
    // Who does not end in time is killed.
    void ask_to_stop();
    bool is_stopped();
    void kill();

 private:
    struct Member {
        std::string name;
        std::vector<std::string> command;
        std::optional<ChildProcess> process;
        int n_restarts = 0;
    };

    void start(Member& member);
    void tend(Member& member, std::vector<std::string>& notes);
    bool has_ended(Member& member);
    std::filesystem::path log_of(const Member& member) const;

    FleetOptions options_;
    std::filesystem::path private_folder_;
    Member coordinator_;
    std::vector<Member> workers_;
    std::chrono::steady_clock::time_point stop_deadline_;
    bool is_coordinator_asked_ = false;
};

}  // namespace misbench
