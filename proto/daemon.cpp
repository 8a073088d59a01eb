#include "proto/daemon.h"

#include <pthread.h>
#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <mutex>

#include "renderer/base/error.h"

namespace misbench {
namespace {

sigset_t stop_signals() {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGTERM);
    sigaddset(&set, SIGINT);
    return set;
}

}  // namespace

void exit_with_parent() {
    const pid_t parent = ::getppid();
    if (::prctl(PR_SET_PDEATHSIG, SIGKILL) != 0) {
        throw Error(Errc::Internal, "ask the kernel for the parent's death: refused");
    }
    // It may have died before we asked.
    if (::getppid() != parent) std::_Exit(exit_code(Errc::Unavailable));
}

StopSignals::StopSignals() {
    const sigset_t set = stop_signals();
    ::pthread_sigmask(SIG_BLOCK, &set, nullptr);
    watcher_ = std::thread([set, this] {
        int signal = 0;
        ::sigwait(&set, &signal);
        source_.request_stop();
    });
}

StopSignals::~StopSignals() {
    ::pthread_kill(watcher_.native_handle(), SIGTERM);
    watcher_.join();
}

void StopSignals::wait() const {
    std::mutex mutex;
    std::condition_variable_any stopped;
    std::unique_lock lock(mutex);
    stopped.wait(lock, token(), [] { return false; });
}

int run_daemon(const std::string& program, const std::function<void()>& body) {
    try {
        body();
        return EXIT_SUCCESS;
    } catch (const Error& error) {
        std::fprintf(stderr, "%s: error: %s\n", program.c_str(), error.what());
        return exit_code(error.code());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s: error: %s\n", program.c_str(), error.what());
        return exit_code(Errc::Internal);
    }
}

}  // namespace misbench
