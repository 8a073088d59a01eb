#include "experiments/cli/fleet.h"

#include <fmt/format.h>
#include <signal.h>
#include <stdlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "renderer/base/error.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;

// A worker drops the pass in flight and gives its task back; a coordinator finishes a commit.
constexpr std::chrono::seconds kPatience{20};

fs::path make_private_folder() {
    std::string name = (fs::temp_directory_path() / "misbench-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
        throw Error(Errc::DataLoss,
                    "make folder '" + name + "': " + std::string(std::strerror(errno)));
    }
    return name;
}

std::string own_folder() { return fs::read_symlink("/proc/self/exe").parent_path().string(); }

// "misbench-coordinator: error: MESSAGE" without what goes before the message.
std::string message_of(const std::string& line) {
    constexpr std::string_view kMark = "error: ";
    const auto mark = line.find(kMark);
    return mark == std::string::npos ? line : line.substr(mark + kMark.size());
}

// What an exit code says of a child: an Error of its own, or that it was killed or crashed.
std::optional<Errc> own_error(int exit_code) {
    if (exit_code == misbench::exit_code(Errc::InvalidArgument)) return Errc::InvalidArgument;
    if (exit_code == misbench::exit_code(Errc::DataLoss)) return Errc::DataLoss;
    return std::nullopt;
}

}  // namespace

Fleet::Fleet(FleetOptions options)
    : options_(std::move(options)), private_folder_(make_private_folder()) {
    fs::create_directories(options_.store / "logs");
    const std::string bin = own_folder();
    coordinator_ = {.name = "coordinator",
                    .command = {bin + "/misbench-coordinator", "--store", options_.store.string(),
                                "--listen", address(), "--address-file",
                                (private_folder_ / "ready").string(), "--exit-with-parent"},
                    .process = {},
                    .n_restarts = 0};
    for (int i = 1; i <= options_.workers; ++i) {
        workers_.push_back(
            {.name = fmt::format("worker-{}", i),
             .command = {bin + "/misbench-worker", "--coordinator", address(), "--threads",
                         std::to_string(options_.threads_per_worker), "--scratch",
                         (private_folder_ / "scratch").string(), "--exit-with-parent"},
             .process = {},
             .n_restarts = 0});
    }
    start(coordinator_);
}

Fleet::~Fleet() {
    workers_.clear();
    coordinator_.process.reset();
    std::error_code ignored;
    fs::remove_all(private_folder_, ignored);
}

std::string Fleet::address() const { return "unix:" + (private_folder_ / "queue").string(); }

bool Fleet::is_coordinator_ready() const { return fs::exists(private_folder_ / "ready"); }

void Fleet::start_workers() {
    for (Member& worker : workers_) start(worker);
}

void Fleet::start(Member& member) {
    member.process.reset();
    member.process.emplace(member.command, log_of(member));
}

fs::path Fleet::log_of(const Member& member) const {
    return options_.store / "logs" / (member.name + ".log");
}

std::vector<std::string> Fleet::tend() {
    std::vector<std::string> notes;
    tend(coordinator_, notes);
    if (!coordinator_.process) {
        throw Error(Errc::Unavailable, fmt::format("keep the coordinator alive: {}; see {}",
                                                   notes.back(), log_of(coordinator_).string()));
    }
    for (Member& worker : workers_) tend(worker, notes);
    return notes;
}

void Fleet::tend(Member& member, std::vector<std::string>& notes) {
    if (!member.process) return;
    member.process->drain();
    const auto code = member.process->exit_code();
    if (!code) return;
    member.process->drain();
    if (const auto error = own_error(*code)) {
        throw Error(*error, member.name + ": " + message_of(member.process->last_line()));
    }
    if (member.n_restarts++ < kMaxRestarts) {
        notes.push_back(
            fmt::format("{} died with exit code {}, started again", member.name, *code));
        start(member);
    } else {
        notes.push_back(fmt::format("{} died {} times, last with exit code {}", member.name,
                                    kMaxRestarts + 1, *code));
        member.process.reset();
    }
}

bool Fleet::has_workers() const {
    return std::ranges::any_of(workers_, [](const Member& w) { return w.process.has_value(); });
}

void Fleet::ask_to_stop() {
    for (Member& worker : workers_) {
        if (worker.process) worker.process->send(SIGTERM);
    }
    stop_deadline_ = std::chrono::steady_clock::now() + kPatience;
}

bool Fleet::is_stopped() {
    const bool is_late = std::chrono::steady_clock::now() > stop_deadline_;
    if (is_late) kill();
    if (!std::ranges::all_of(workers_, [this](Member& w) { return has_ended(w); })) return false;
    if (!is_coordinator_asked_) {
        is_coordinator_asked_ = true;
        if (coordinator_.process) coordinator_.process->send(SIGTERM);
        stop_deadline_ = std::chrono::steady_clock::now() + kPatience;
    }
    return has_ended(coordinator_);
}

bool Fleet::has_ended(Member& member) {
    if (member.process) member.process->drain();
    return !member.process || member.process->exit_code().has_value();
}

void Fleet::kill() {
    for (Member& worker : workers_) {
        if (worker.process) worker.process->send(SIGKILL);
    }
    if (coordinator_.process) coordinator_.process->send(SIGKILL);
}

}  // namespace misbench
