#include "experiments/cli/child_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <utility>

#include "renderer/base/error.h"

namespace misbench {
namespace {

// In the child, between fork and exec: only what is safe there in a process that had threads.
[[noreturn]] void become(char* const* arguments, int output, pid_t parent) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(127);
    ::setpgid(0, 0);
    ::signal(SIGPIPE, SIG_DFL);
    sigset_t none;
    ::sigemptyset(&none);
    ::pthread_sigmask(SIG_SETMASK, &none, nullptr);
    ::dup2(output, STDOUT_FILENO);
    ::dup2(output, STDERR_FILENO);
    ::execv(arguments[0], arguments);
    ::_exit(127);
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& command, std::filesystem::path log)
    : log_(std::move(log)) {
    const auto fail = [&command](int reason) {
        throw Error(Errc::Internal, "start '" + command.front() + "': " + std::strerror(reason));
    };
    if (::access(command.front().c_str(), X_OK) != 0) fail(errno);
    std::array<int, 2> pipe{};
    if (::pipe2(pipe.data(), O_CLOEXEC) != 0) fail(errno);
    ::fcntl(pipe[0], F_SETFL, O_NONBLOCK);
    std::vector<std::string> copies = command;
    std::vector<char*> arguments;
    for (std::string& argument : copies) arguments.push_back(argument.data());
    arguments.push_back(nullptr);

    const pid_t parent = ::getpid();
    pid_ = ::fork();
    if (pid_ == 0) become(arguments.data(), pipe[1], parent);
    const int reason = errno;
    ::close(pipe[1]);
    output_ = pipe[0];
    if (pid_ < 0) {
        ::close(output_);
        fail(reason);
    }
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept { *this = std::move(other); }

ChildProcess& ChildProcess::operator=(ChildProcess&& other) noexcept {
    std::swap(pid_, other.pid_);
    std::swap(output_, other.output_);
    std::swap(log_, other.log_);
    std::swap(last_line_, other.last_line_);
    std::swap(unfinished_line_, other.unfinished_line_);
    std::swap(exit_code_, other.exit_code_);
    return *this;
}

ChildProcess::~ChildProcess() {
    if (pid_ < 0) return;
    if (!exit_code()) {
        send(SIGKILL);
        ::waitpid(pid_, nullptr, 0);
    }
    drain();
    ::close(output_);
}

void ChildProcess::drain() {
    std::array<char, 4096> buffer{};
    std::string text;
    for (ssize_t n = 0; (n = ::read(output_, buffer.data(), buffer.size())) > 0;) {
        text.append(buffer.data(), static_cast<std::size_t>(n));
    }
    if (text.empty()) return;
    std::ofstream(log_, std::ios::app) << text;
    for (const char c : text) {
        if (c != '\n') {
            unfinished_line_ += c;
        } else {
            last_line_ = std::exchange(unfinished_line_, {});
        }
    }
}

std::optional<int> ChildProcess::exit_code() {
    int status = 0;
    if (!exit_code_ && ::waitpid(pid_, &status, WNOHANG) == pid_) {
        exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    return exit_code_;
}

void ChildProcess::send(int signal) {
    if (!exit_code()) ::kill(pid_, signal);
}

}  // namespace misbench
