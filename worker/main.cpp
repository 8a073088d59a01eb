// misbench-worker: does the tasks that a coordinator gives it.
#include <CLI/CLI.hpp>

#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "proto/daemon.h"
#include "renderer/base/build_info.h"
#include "renderer/base/error.h"
#include "renderer/base/log.h"
#include "worker/provenance.h"
#include "worker/session.h"
#include "worker/task_runner.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr milliseconds kShortestDeadline{1'000};
constexpr milliseconds kLongestDeadline{10'000};

struct Options {
    std::string coordinator;
    int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    std::string scratch = fs::temp_directory_path() / "misbench";
    std::int64_t give_up_seconds = 300;
    std::string log_level = "info";
    bool with_parent = false;
};

void declare(CLI::App& app, Options& options) {
    app.add_option("--coordinator", options.coordinator, "its address: unix:/path or host:port")
        ->required();
    app.add_option("--threads", options.threads, "render threads")
        ->check(CLI::Range(1, 4096))
        ->capture_default_str();
    app.add_option("--scratch", options.scratch, "where results lie until they are delivered")
        ->capture_default_str();
    app.add_option("--give-up-seconds", options.give_up_seconds,
                   "how long to wait for a coordinator that does not answer")
        ->check(CLI::Range(0, 1'000'000))
        ->capture_default_str();
    app.add_flag("--exit-with-parent", options.with_parent,
                 "die with the process that started this one");
    app.add_option("--log-level", options.log_level, "debug info warning error critical off")
        ->capture_default_str();
}

// Unique among the living and the recently dead.
std::string make_worker_name() {
    const auto started = std::chrono::duration_cast<milliseconds>(
        std::chrono::system_clock::now().time_since_epoch());
    return host_name() + ":" + std::to_string(::getpid()) + ":" + std::to_string(started.count());
}

void interruptible_sleep(milliseconds duration, std::stop_token stop) {
    std::mutex mutex;
    std::condition_variable_any stopped;
    std::unique_lock lock(mutex);
    stopped.wait_for(lock, stop, duration, [] { return false; });
}

// A directory of this worker alone, which goes with it.
struct Scratch {
    fs::path folder;
    explicit Scratch(fs::path path) : folder(std::move(path)) {
        std::error_code failure;
        fs::create_directories(folder, failure);
        if (failure) {
            throw Error(Errc::InvalidArgument,
                        "make scratch directory '" + folder.string() + "': " + failure.message());
        }
    }
    ~Scratch() {
        std::error_code ignored;
        fs::remove_all(folder, ignored);
    }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
};

void serve(const Options& options) {
    if (options.with_parent) exit_with_parent();
    init_log("misbench-worker", options.log_level);
    const StopSignals stop;
    const std::string name = make_worker_name();
    const Scratch scratch(fs::path(options.scratch) / name);
    const std::chrono::seconds patience(options.give_up_seconds);
    QueueClient client(options.coordinator,
                       std::clamp<milliseconds>(patience, kShortestDeadline, kLongestDeadline));
    TaskRunner runner(name, options.threads, scratch.folder);
    Session session(
        {.synchronize =
             [&](const WorkerReport& report) {
                 return client.synchronize(name, build_id(), report);
             },
         .upload = [&](const LeaseRef& lease, const std::string& file,
                       const std::string& bytes) { client.upload(lease, file, bytes); },
         .commit = [&](const LeaseRef& lease,
                       const auto& artefacts) { return client.commit(lease, artefacts); },
         .run = [&](const LeaseRef& lease, const Task& task,
                    const auto& abandon) { return runner.run(lease, task, abandon); },
         .now = [] { return std::chrono::steady_clock::now(); },
         .pause = interruptible_sleep},
        patience);
    spdlog::info("worker started name={} coordinator={} threads={}", name, options.coordinator,
                 options.threads);
    session.run(stop.token());
    spdlog::info("worker stopped name={}", name);
}

}  // namespace
}  // namespace misbench

int main(int argc, char** argv) {
    misbench::Options options;
    CLI::App app("Does the tasks that a coordinator gives it.", "misbench-worker");
    misbench::declare(app, options);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        return app.exit(e) == 0 ? 0 : 2;
    }
    return misbench::run_daemon("misbench-worker", [&] { misbench::serve(options); });
}
