// What the coordinator and the worker share as processes: how they are asked to end, and how they
// tell why they did.
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <thread>

namespace misbench {

// Dies with the process that started this one, also when that one is killed. Call first in main():
// the kernel watches the thread that forked us, and tells the thread that asks.
void exit_with_parent();

// SIGTERM and SIGINT as a stop token. Construct before any other thread starts, so that all inherit
// the blocked signals and only the thread in here receives them.
class StopSignals {
 public:
    StopSignals();
    ~StopSignals();
    StopSignals(const StopSignals&) = delete;
    StopSignals& operator=(const StopSignals&) = delete;

    std::stop_token token() const { return source_.get_token(); }
    // Blocks until a signal has come.
    void wait() const;

 private:
    std::stop_source source_;
    std::thread watcher_;
};

// Runs `body`, prints the one line of an Error to stderr, and returns the process's exit code.
int run_daemon(const std::string& program, const std::function<void()>& body);

}  // namespace misbench
