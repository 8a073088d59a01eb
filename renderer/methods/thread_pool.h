// Render threads: a fixed number of them, so that CPU time can be read per render and "threads: 2"
// means two. They live as long as the render.
#pragma once

#include <pthread.h>

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace misbench {

class ThreadPool {
 public:
    explicit ThreadPool(int n_threads);
    ~ThreadPool();
    ThreadPool(const ThreadPool&) = delete;
    ThreadPool& operator=(const ThreadPool&) = delete;

    int size() const { return static_cast<int>(threads_.size()); }

    // Runs work(i) for every i in [0, n), in no particular order, and waits. `stop` is asked before
    // each; once it says true no further one is begun. Returns whether all were done. Not
    // re-entrant. An exception of work() is rethrown here.
    bool for_each(std::size_t n, const std::function<bool()>& stop,
                  const std::function<void(std::size_t)>& work);

    // CPU seconds used since the pool was made by its threads and by the one that made it, which
    // must still run: what that does between two jobs is work too.
    double cpu_seconds() const;

 private:
    void run();
    void drain();

    std::mutex mutex_;
    std::condition_variable wake_;
    std::condition_variable finished_;
    std::size_t generation_ = 0;  // of the current job; threads wait for it to change
    std::size_t n_busy_ = 0;
    bool exiting_ = false;
    std::exception_ptr failure_;

    const std::function<bool()>* stop_ = nullptr;
    const std::function<void(std::size_t)>* work_ = nullptr;
    std::size_t n_ = 0;
    std::atomic<std::size_t> next_ = 0;
    std::atomic<bool> stopped_ = false;

    pthread_t owner_;
    double owner_cpu_seconds_;           // when the pool was made
    std::vector<std::jthread> threads_;  // last: they use all the rest
};

}  // namespace misbench
