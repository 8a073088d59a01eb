// Programs as a user runs them, for tests: exit code, stdout and stderr, signals, children.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace misbench {

struct Outcome {
    int exit_code = 0;  // 128 + signal when killed
    std::string out;
    std::string err;
};

inline std::string slurp(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

// True as soon as `condition` holds, false when it does not within `limit`.
inline bool wait_until(const std::function<bool()>& condition,
                       std::chrono::milliseconds limit = std::chrono::seconds(60)) {
    const auto deadline = std::chrono::steady_clock::now() + limit;
    while (!condition()) {
        if (std::chrono::steady_clock::now() > deadline) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return true;
}

// A process that is gone, or a zombie that nobody has reaped yet.
inline bool is_dead(pid_t pid) {
    const std::string stat = slurp("/proc/" + std::to_string(pid) + "/stat");
    const auto name_end = stat.rfind(')');
    return name_end == std::string::npos || stat.at(name_end + 2) == 'Z';
}

inline std::vector<pid_t> children_of(pid_t pid) {
    const std::string id = std::to_string(pid);
    std::istringstream list(slurp("/proc/" + id + "/task/" + id + "/children"));
    return {std::istream_iterator<pid_t>(list), std::istream_iterator<pid_t>()};
}

// The command line of a process, arguments separated by spaces.
inline std::string command_of(pid_t pid) {
    std::string command = slurp("/proc/" + std::to_string(pid) + "/cmdline");
    for (char& c : command) {
        if (c == '\0') c = ' ';
    }
    return command;
}

struct ProcessOptions {
    std::map<std::string, std::string> environment = {};
    std::string stdout_file = {};  // "" keeps it for Outcome
    bool as_nobody = false;        // for what root may and others may not
};

// A program in a process group of its own, like a shell's job.
class Process {
 public:
    Process(const std::vector<std::string>& command, const std::filesystem::path& scratch,
            const ProcessOptions& options = {}) {
        static int n_started = 0;
        const std::string name = "process" + std::to_string(++n_started);
        const bool keeps_out = options.stdout_file.empty();
        if (keeps_out) out_ = (scratch / (name + ".out")).string();
        err_ = (scratch / (name + ".err")).string();
        std::vector<char*> arguments;
        std::vector<std::string> copies = command;
        for (std::string& argument : copies) arguments.push_back(argument.data());
        arguments.push_back(nullptr);
        pid_ = ::fork();
        if (pid_ != 0) return;
        ::setpgid(0, 0);
        open_as(keeps_out ? out_ : options.stdout_file, STDOUT_FILENO);
        open_as(err_, STDERR_FILENO);
        for (const auto& [key, value] : options.environment) {
            ::setenv(key.c_str(), value.c_str(), 1);
        }
        constexpr unsigned kNobody = 65534;
        if (options.as_nobody && (::setgid(kNobody) != 0 || ::setuid(kNobody) != 0)) ::_exit(126);
        ::execv(arguments[0], arguments.data());
        ::_exit(127);
    }
    ~Process() {
        if (!is_waited_) {
            ::kill(pid_, SIGKILL);
            ::waitpid(pid_, nullptr, 0);
        }
    }
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;

    pid_t pid() const { return pid_; }
    // To the whole process group, as a terminal does with Ctrl-C.
    void send_to_group(int signal) const { ::kill(-pid_, signal); }
    std::string err_so_far() const { return slurp(err_); }

    Outcome wait() {
        int status = 0;
        ::waitpid(pid_, &status, 0);
        is_waited_ = true;
        return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), slurp(out_),
                slurp(err_)};
    }

 private:
    static void open_as(const std::string& file, int descriptor) {
        const int opened = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
        if (opened < 0 || ::dup2(opened, descriptor) < 0) ::_exit(125);
    }

    pid_t pid_ = -1;
    bool is_waited_ = false;
    std::string out_;
    std::string err_;
};

}  // namespace misbench
