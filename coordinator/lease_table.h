// Which worker may work on which task until when. No clock, no thread, no socket, no database:
// time is an argument, so a test can be any schedule of events.
//
// The tasks of a block go to one worker, in an order shuffled within the block, so that neither a
// slow machine nor one that grows warm favours a method. A block changes hands only when its worker
// has died, that is, has been silent for the lease's time.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "proto/client.h"
#include "results/store.h"

namespace misbench {

struct LeasePolicy {
    std::chrono::milliseconds ttl{15'000};
    int max_losses = 5;    // workers that may die of a task before it fails
    int max_failures = 2;  // attempts; the second one elsewhere if there is an elsewhere
    std::uint64_t order_seed = 0;
};

enum class Renewal { Renewed, Revived, Lost };

class LeaseTable {
 public:
    using Time = std::chrono::steady_clock::time_point;

    // The job table as it was stored. Leases in it stay with their workers for a fresh ttl: it was
    // perhaps the coordinator that died, not they.
    LeaseTable(std::vector<TaskRow> rows, LeasePolicy policy, Time now);

    // The next task for this worker, if there is one for it now. A worker that already holds a
    // lease is given the same again: its last answer was lost. `next_epoch` is called only for a
    // new grant, and must return more than ever before.
    std::optional<LeaseRef> acquire(const std::string& worker, Time now,
                                    const std::function<std::int64_t()>& next_epoch);

    // A lease that expired is as good as a live one until the task is granted again: it revives.
    Renewal renew(const LeaseRef& lease, Time now);
    // What complete() would say. A result is accepted from the last grant only.
    [[nodiscard]] CommitOutcome standing(const LeaseRef& lease) const;
    CommitOutcome complete(const LeaseRef& lease, Time now);
    // The worker gives the lease back, with or without blame. False: it was lost, nothing changes.
    bool fail(const LeaseRef& lease, const std::string& error, Time now);
    bool release(const LeaseRef& lease, Time now);

    // The worker wants no more work: others need not wait for it. REQUIRES: it holds no lease.
    void depart(const std::string& worker);
    // Takes back what was not renewed in time. Returns the tasks that changed.
    std::vector<std::string> expire(Time now);

    struct Entry {
        TaskRow row;
        Time granted{};
        Time deadline{};       // of a Leased task
        bool expired = false;  // Pending or Failed because the lease ran out, and not granted since
    };
    const Entry* find(const std::string& task) const;
    const std::vector<Entry>& entries() const { return entries_; }
    const LeasePolicy& policy() const { return policy_; }

 private:
    struct Block {
        std::string owner;               // "" before the first grant
        std::vector<std::size_t> order;  // into entries_
    };
    struct Candidate;

    void make_blocks();
    bool alive(const std::string& worker, Time now) const;
    bool alone(const std::string& worker, Time now) const;
    std::optional<Candidate> best_for(const std::string& worker, Time now);
    void grant(std::size_t idx, const std::string& worker, Time now);
    std::optional<std::size_t> index(const std::string& task) const;
    std::optional<std::size_t> holding(const LeaseRef& lease, Time now);

    LeasePolicy policy_;
    std::vector<Entry> entries_;                          // by position
    std::unordered_map<std::string, std::size_t> index_;  // task id → entries_
    std::set<std::size_t> leased_;                        // into entries_
    std::vector<Block> blocks_;                           // by their first position
    std::map<std::string, Time> contact_;                 // worker → last call
};

}  // namespace misbench
