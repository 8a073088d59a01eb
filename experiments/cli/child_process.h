// A process that we started: in a process group of its own, so that the terminal's Ctrl-C reaches
// only us, and bound to the life of the thread that started it, so that nothing survives us.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace misbench {

class ChildProcess {
 public:
    // Starts a program; its stdout and stderr are appended to `log`. The calling thread must live
    // as long as the child is wanted: the kernel kills the child when it ends.
    ChildProcess(const std::vector<std::string>& command, std::filesystem::path log);
    // Kills the child if it lives.
    ~ChildProcess();
    ChildProcess(ChildProcess&& other) noexcept;
    ChildProcess& operator=(ChildProcess&& other) noexcept;

    // Moves what the child has written to the log. To be called now and then: the child waits when
    // too much is left.
    void drain();
    // The last whole line that was drained, also when the log's disk is full.
    const std::string& last_line() const { return last_line_; }
    // How the child ended: its exit code, or 128 + the signal. Absent while it lives.
    std::optional<int> exit_code();
    void send(int signal);

 private:
    pid_t pid_ = -1;
    int output_ = -1;  // our end of the pipe
    std::filesystem::path log_;
    std::string last_line_;
    std::string unfinished_line_;
    std::optional<int> exit_code_;
};

}  // namespace misbench
