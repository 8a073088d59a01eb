#include "renderer/methods/thread_pool.h"

#include <time.h>

#include <exception>
#include <utility>

#include "renderer/base/check.h"

namespace misbench {

namespace {

double cpu_seconds_of(pthread_t thread) {
    clockid_t clock{};
    timespec time{};
    MISBENCH_CHECK(pthread_getcpuclockid(thread, &clock) == 0);
    MISBENCH_CHECK(clock_gettime(clock, &time) == 0);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

ThreadPool::ThreadPool(int n_threads)
    : owner_(pthread_self()), owner_cpu_seconds_(cpu_seconds_of(owner_)) {
    MISBENCH_CHECK(n_threads > 0);
    for (int i = 0; i < n_threads; ++i) threads_.emplace_back([this] { run(); });
}

ThreadPool::~ThreadPool() {
    {
        const std::lock_guard lock(mutex_);
        exiting_ = true;
    }
    wake_.notify_all();
}

void ThreadPool::run() {
    std::size_t seen = 0;
    std::unique_lock lock(mutex_);
    while (true) {
        wake_.wait(lock, [&] { return exiting_ || generation_ != seen; });
        if (exiting_) return;
        seen = generation_;
        lock.unlock();
        try {
            drain();
        } catch (...) {
            stopped_ = true;
            const std::lock_guard relock(mutex_);
            failure_ = std::current_exception();
        }
        lock.lock();
        if (--n_busy_ == 0) finished_.notify_one();
    }
}

void ThreadPool::drain() {
    for (std::size_t i = next_++; i < n_; i = next_++) {
        if (stopped_ || (*stop_)()) {
            stopped_ = true;
            return;
        }
        (*work_)(i);
    }
}

bool ThreadPool::for_each(std::size_t n, const std::function<bool()>& stop,
                          const std::function<void(std::size_t)>& work) {
    std::unique_lock lock(mutex_);
    stop_ = &stop;
    work_ = &work;
    n_ = n;
    next_ = 0;
    stopped_ = false;
    n_busy_ = threads_.size();
    ++generation_;
    wake_.notify_all();
    finished_.wait(lock, [&] { return n_busy_ == 0; });
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
    return !stopped_;
}

double ThreadPool::cpu_seconds() const {
    double total = cpu_seconds_of(owner_) - owner_cpu_seconds_;
    // The threads live as long as the pool, so their clocks are there.
    for (const std::jthread& thread : threads_) {
        total += cpu_seconds_of(const_cast<std::jthread&>(thread).native_handle());
    }
    return total;
}

}  // namespace misbench
