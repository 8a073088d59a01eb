// The lease table in virtual time: first what it promises, one promise a test, then 200 random
// schedules of everything that can happen to workers and to the coordinator.
#include "coordinator/lease_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

namespace misbench {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Time = LeaseTable::Time;

constexpr seconds kTtl{10};
const Time kStart = Time() + std::chrono::hours(1);

// `n_tasks` tasks in each of `n_blocks` blocks, named "b0.t0" and so on.
std::vector<TaskRow> make_rows(int n_blocks, int n_tasks) {
    std::vector<TaskRow> rows;
    for (int b = 0; b < n_blocks; ++b) {
        for (int t = 0; t < n_tasks; ++t) {
            TaskRow row;
            row.block = "b" + std::to_string(b);
            row.id = row.block + ".t" + std::to_string(t);
            row.position = std::int64_t{b} * n_tasks + t;
            rows.push_back(row);
        }
    }
    return rows;
}

class Table : public testing::Test {
 protected:
    LeaseTable make(int n_blocks, int n_tasks) {
        return {make_rows(n_blocks, n_tasks), {.ttl = kTtl}, kStart};
    }
    std::optional<LeaseRef> acquire(LeaseTable& table, const std::string& worker, Time now) {
        return table.acquire(worker, now, [this] { return ++epoch_; });
    }
    LeaseRef must_acquire(LeaseTable& table, const std::string& worker, Time now) {
        const auto lease = acquire(table, worker, now);
        EXPECT_TRUE(lease.has_value());
        return lease.value_or(LeaseRef{});
    }
    static const TaskRow& row(const LeaseTable& table, const std::string& task) {
        return table.find(task)->row;
    }

    std::int64_t epoch_ = 0;
};
using LeaseTableTest = Table;

TEST_F(LeaseTableTest, WorkerThatCameBackFromTheDeadIsTurnedAway) {
    LeaseTable table = make(1, 1);
    const LeaseRef old = must_acquire(table, "zombie", kStart);
    table.expire(kStart + kTtl);
    const LeaseRef fresh = must_acquire(table, "heir", kStart + kTtl);
    EXPECT_EQ(fresh.task, old.task);
    EXPECT_GT(fresh.epoch, old.epoch);

    EXPECT_EQ(table.renew(old, kStart + kTtl), Renewal::Lost);
    EXPECT_EQ(table.complete(old, kStart + kTtl), CommitOutcome::Stale);
    EXPECT_FALSE(table.fail(old, "too late", kStart + kTtl));
    EXPECT_FALSE(table.release(old, kStart + kTtl));
    EXPECT_EQ(table.complete(fresh, kStart + kTtl), CommitOutcome::Accepted);
    EXPECT_EQ(table.complete(fresh, kStart + kTtl), CommitOutcome::AlreadyDone);
}

TEST_F(LeaseTableTest, LateResultCountsWhileNobodyElseWasGivenTheTask) {
    LeaseTable table = make(1, 1);
    const LeaseRef lease = must_acquire(table, "slow", kStart);
    EXPECT_THAT(table.expire(kStart + 2 * kTtl), testing::ElementsAre(lease.task));
    EXPECT_EQ(table.complete(lease, kStart + 3 * kTtl), CommitOutcome::Accepted);
    EXPECT_EQ(row(table, lease.task).state, TaskState::Done);
    EXPECT_FALSE(acquire(table, "other", kStart + 3 * kTtl).has_value());
}

TEST_F(LeaseTableTest, LateRenewalRevivesALeaseAndIsNoLoss) {
    LeaseTable table = make(1, 1);
    const LeaseRef lease = must_acquire(table, "slow", kStart);
    EXPECT_EQ(table.renew(lease, kStart + kTtl / 2), Renewal::Renewed);
    table.expire(kStart + 2 * kTtl);
    EXPECT_EQ(row(table, lease.task).losses, 1);
    EXPECT_EQ(table.renew(lease, kStart + 2 * kTtl), Renewal::Revived);
    EXPECT_EQ(row(table, lease.task).losses, 0);
    EXPECT_FALSE(acquire(table, "other", kStart + 2 * kTtl).has_value());
}

TEST_F(LeaseTableTest, RenewalKeepsALeaseForAnotherTtlAndNoLonger) {
    LeaseTable table = make(1, 1);
    const LeaseRef lease = must_acquire(table, "w", kStart);
    table.renew(lease, kStart + kTtl / 2);
    EXPECT_THAT(table.expire(kStart + kTtl + kTtl / 2 - milliseconds(1)), testing::IsEmpty());
    EXPECT_THAT(table.expire(kStart + kTtl + kTtl / 2), testing::ElementsAre(lease.task));
}

TEST_F(LeaseTableTest, WorkerWhoseAnswerWasLostGetsTheSameLeaseAgain) {
    LeaseTable table = make(2, 2);
    const LeaseRef first = must_acquire(table, "w", kStart);
    EXPECT_EQ(acquire(table, "w", kStart + seconds(1)), first);
    EXPECT_EQ(epoch_, 1);
}

TEST_F(LeaseTableTest, ReleasedTaskIsFreeAtOnceAndWithoutBlame) {
    LeaseTable table = make(1, 1);
    const LeaseRef lease = must_acquire(table, "leaver", kStart);
    EXPECT_TRUE(table.release(lease, kStart));
    table.depart("leaver");
    EXPECT_EQ(row(table, lease.task).losses, 0);
    EXPECT_EQ(row(table, lease.task).failures, 0);
    EXPECT_EQ(table.renew(lease, kStart), Renewal::Lost);
    EXPECT_TRUE(acquire(table, "other", kStart).has_value());
}

TEST_F(LeaseTableTest, BlockStaysWithItsWorkerAndIsShuffledTheSameEveryTime) {
    const auto order = [this](std::uint64_t seed) {
        LeaseTable table(make_rows(2, 12), {.ttl = kTtl, .order_seed = seed}, kStart);
        std::vector<std::string> tasks;
        for (int i = 0; i < 12; ++i) {
            const LeaseRef a = must_acquire(table, "a", kStart);
            const LeaseRef b = must_acquire(table, "b", kStart);
            EXPECT_EQ(row(table, a.task).block, "b0");
            EXPECT_EQ(row(table, b.task).block, "b1");
            tasks.push_back(a.task);
            table.complete(a, kStart);
            table.complete(b, kStart);
        }
        return tasks;
    };
    EXPECT_EQ(order(1), order(1));
    EXPECT_NE(order(1), order(2));
    std::vector<std::string> as_planned;
    for (const TaskRow& r : make_rows(1, 12)) as_planned.push_back(r.id);
    EXPECT_NE(order(1), as_planned);
    EXPECT_THAT(order(1), testing::UnorderedElementsAreArray(as_planned));
}

TEST_F(LeaseTableTest, TwoBlocksAreShuffledDifferently) {
    LeaseTable table = make(2, 12);
    std::vector<std::string> orders[2];
    for (int i = 0; i < 24; ++i) {
        const LeaseRef lease = must_acquire(table, "w", kStart);
        orders[i / 12].push_back(lease.task.substr(lease.task.find('.')));
        table.complete(lease, kStart);
    }
    EXPECT_NE(orders[0], orders[1]);
}

TEST_F(LeaseTableTest, IdleWorkerWaitsRatherThanSplitABlock) {
    LeaseTable table = make(1, 3);
    must_acquire(table, "owner", kStart);
    EXPECT_FALSE(acquire(table, "idler", kStart + seconds(1)).has_value());
}

TEST_F(LeaseTableTest, BlockOfADeadWorkerIsTakenOver) {
    LeaseTable table = make(1, 3);
    const LeaseRef done = must_acquire(table, "owner", kStart);
    table.complete(done, kStart);
    EXPECT_FALSE(acquire(table, "heir", kStart + kTtl - milliseconds(1)).has_value());
    EXPECT_TRUE(acquire(table, "heir", kStart + kTtl).has_value());
}

TEST_F(LeaseTableTest, BlockOfAWorkerThatLeftIsTakenOverAtOnce) {
    LeaseTable table = make(1, 3);
    table.complete(must_acquire(table, "owner", kStart), kStart);
    table.depart("owner");
    EXPECT_TRUE(acquire(table, "heir", kStart).has_value());
}

TEST_F(LeaseTableTest, TaskThatKillsItsWorkersFailsInTheEnd) {
    LeaseTable table = make(1, 1);
    Time now = kStart;
    for (int loss = 1; loss <= LeasePolicy().max_losses; ++loss) {
        ASSERT_TRUE(acquire(table, "w" + std::to_string(loss), now).has_value()) << loss;
        table.expire(now += kTtl);
    }
    EXPECT_EQ(row(table, "b0.t0").state, TaskState::Failed);
    EXPECT_EQ(row(table, "b0.t0").error, "5 workers were lost while they worked on it");
    EXPECT_FALSE(acquire(table, "next", now).has_value());
}

TEST_F(LeaseTableTest, FailedTaskIsTriedOnceMoreElsewhere) {
    LeaseTable table = make(1, 2);
    const LeaseRef first = must_acquire(table, "owner", kStart);
    EXPECT_FALSE(acquire(table, "other", kStart).has_value());
    EXPECT_TRUE(table.fail(first, "out of luck", kStart));
    const LeaseRef next = must_acquire(table, "owner", kStart);
    EXPECT_NE(next.task, first.task);
    table.complete(next, kStart);
    EXPECT_FALSE(acquire(table, "owner", kStart).has_value());

    const LeaseRef second = must_acquire(table, "other", kStart);
    EXPECT_EQ(second.task, first.task);
    EXPECT_TRUE(table.fail(second, "again", kStart));
    EXPECT_EQ(row(table, first.task).state, TaskState::Failed);
    EXPECT_EQ(row(table, first.task).error, "again");
}

TEST_F(LeaseTableTest, FailedTaskIsTriedOnceMoreHereWhenThereIsNoElsewhere) {
    LeaseTable table = make(1, 1);
    const LeaseRef first = must_acquire(table, "only", kStart);
    table.fail(first, "out of luck", kStart);
    EXPECT_EQ(must_acquire(table, "only", kStart).task, first.task);
}

TEST_F(LeaseTableTest, RestartKeepsLeasesWithTheirWorkersAndEpochs) {
    LeaseTable before = make(2, 2);
    const LeaseRef lease = must_acquire(before, "w", kStart);
    std::vector<TaskRow> stored;
    for (const auto& entry : before.entries()) stored.push_back(entry.row);

    const Time later = kStart + 100 * kTtl;
    LeaseTable after(stored, {.ttl = kTtl}, later);
    EXPECT_THAT(after.expire(later + kTtl - milliseconds(1)), testing::IsEmpty());
    const LeaseRef other = must_acquire(after, "other", later);
    EXPECT_NE(row(after, other.task).block, row(after, lease.task).block);
    EXPECT_EQ(after.renew(lease, later + seconds(1)), Renewal::Renewed);
    EXPECT_EQ(after.complete(lease, later + seconds(1)), CommitOutcome::Accepted);
}

TEST_F(LeaseTableTest, UnknownTaskIsStale) {
    LeaseTable table = make(1, 1);
    EXPECT_EQ(table.complete({"nobody's", 1}, kStart), CommitOutcome::Stale);
    EXPECT_EQ(table.renew({"nobody's", 1}, kStart), Renewal::Lost);
}

// --- random schedules ------------------------------------------------------------------------

// A few workers and a coordinator to whom everything happens. Keeps its own books, by which each
// answer of the table is judged.
class World {
 public:
    explicit World(unsigned seed)
        : random_(seed),
          n_blocks_(between(1, 5)),
          table_(make_rows(n_blocks_, between(1, 6)), policy_, kStart) {
        for (int n = between(1, 4); n > 0; --n) hire();
    }

    void chaos() {
        for (int n = between(20, 200); n > 0; --n) {
            now_ +=
                chance(0.05) ? milliseconds(between(1, 30'000)) : milliseconds(between(0, 2'000));
            something_happens();
            check();
        }
    }

    // From here on all workers behave; whatever is left must end.
    void calm() {
        if (workers_.empty()) hire();
        const int n_steps = 40 * static_cast<int>(table_.entries().size()) + 400;
        for (int step = 0; step < n_steps && !ended(); ++step) {
            now_ += seconds(1);
            for (Worker& worker : workers_) {
                ask(worker);
                if (worker.lease && chance(0.7)) complete(worker);
            }
            check();
        }
        EXPECT_TRUE(ended());
        for (const auto& entry : table_.entries()) check_end(entry.row);
    }

 private:
    struct Worker {
        std::string name;
        std::optional<LeaseRef> lease;  // what it believes to hold
    };

    int between(int low, int high) { return std::uniform_int_distribution(low, high)(random_); }
    bool chance(double p) { return std::bernoulli_distribution(p)(random_); }
    Worker& any_worker() {
        if (workers_.empty()) hire();
        return workers_[static_cast<std::size_t>(
            between(0, static_cast<int>(workers_.size()) - 1))];
    }
    void hire() { workers_.push_back({.name = "w" + std::to_string(++n_hired_), .lease = {}}); }
    void bury(const Worker& worker) {
        const std::string name = worker.name;
        std::erase_if(workers_, [&](const Worker& w) { return w.name == name; });
        if (chance(0.8)) hire();
    }

    void something_happens() {
        expire();
        Worker& worker = any_worker();
        switch (between(0, 11)) {
            case 0:
                return restart();
            case 1:
                return bury(worker);  // kill -9: its lease stays behind
            case 2:
                return fail(worker);
            case 3:
                return leave(worker);
            case 4:
                return late_messages();
            case 5:
            case 6:
                return complete(worker);
            default:
                return ask(worker);
        }
    }

    void ask(Worker& worker) {
        if (worker.lease) {
            const Renewal renewal = table_.renew(*worker.lease, now_);
            if (renewal == Renewal::Lost) {
                worker.lease.reset();
            } else {
                contact_[worker.name] = now_;
            }
            return;
        }
        const std::int64_t before = epoch_;
        worker.lease = table_.acquire(worker.name, now_, [this] { return ++epoch_; });
        if (worker.lease && epoch_ > before) check_grant(worker);
        contact_[worker.name] = now_;
    }

    void check_grant(const Worker& worker) {
        const TaskRow& row = table_.find(worker.lease->task)->row;
        history_.push_back(*worker.lease);
        EXPECT_EQ(row.epoch, epoch_);
        EXPECT_GT(worker.lease->epoch, last_epoch_[row.id]) << "epochs must grow";
        last_epoch_[row.id] = worker.lease->epoch;
        EXPECT_EQ(n_accepted_[row.id], 0) << "granted after it was done";
        EXPECT_LT(row.failures, policy_.max_failures);
        EXPECT_LT(row.losses, policy_.max_losses);
        // A retry may leave a living owner's block; nothing else may.
        if (row.failures == 0) {
            EXPECT_FALSE(owned_by_another(row.block, worker.name))
                << "block " << row.block << " was split between two living workers";
        }
        if (!owned_by_another(row.block, worker.name)) owner_[row.block] = worker.name;
    }

    bool owned_by_another(const std::string& block, const std::string& worker) const {
        const auto owner = owner_.find(block);
        if (owner == owner_.end() || owner->second == worker) return false;
        const auto contact = contact_.find(owner->second);
        return contact != contact_.end() && now_ - contact->second < kTtl;
    }

    void complete(Worker& worker) {
        if (!worker.lease) return;
        deliver(*worker.lease, worker.name);
        if (chance(0.3)) deliver(*worker.lease, worker.name);  // the first answer was lost
        worker.lease.reset();
    }

    void deliver(const LeaseRef& lease, const std::string& worker) {
        const CommitOutcome outcome = table_.complete(lease, now_);
        int& accepted = n_accepted_[lease.task];
        if (accepted > 0) {
            EXPECT_EQ(outcome, CommitOutcome::AlreadyDone);
        } else {
            EXPECT_EQ(outcome == CommitOutcome::Accepted, lease.epoch == last_epoch_[lease.task]);
        }
        if (outcome == CommitOutcome::Accepted) {
            ++accepted;
            contact_[worker] = now_;
        }
    }

    void fail(Worker& worker) {
        if (!worker.lease) return;
        if (table_.fail(*worker.lease, "bad luck", now_)) contact_[worker.name] = now_;
        worker.lease.reset();
    }

    void leave(Worker& worker) {
        if (worker.lease) table_.release(*worker.lease, now_);
        table_.depart(worker.name);
        contact_.erase(worker.name);
        bury(worker);
    }

    // Messages of any past lease arrive once more. A worker that holds it still sends them anyway.
    void late_messages() {
        if (history_.empty()) return;
        const auto n = static_cast<int>(history_.size());
        const LeaseRef lease = history_[static_cast<std::size_t>(between(0, n - 1))];
        const bool current = std::any_of(workers_.begin(), workers_.end(),
                                         [&](const Worker& w) { return w.lease == lease; });
        if (current || lease.epoch == last_epoch_[lease.task]) return;
        EXPECT_EQ(table_.renew(lease, now_), Renewal::Lost);
        EXPECT_FALSE(table_.fail(lease, "late", now_));
        EXPECT_FALSE(table_.release(lease, now_));
        EXPECT_NE(table_.complete(lease, now_), CommitOutcome::Accepted);
    }

    void restart() {
        std::vector<TaskRow> stored;
        for (const auto& entry : table_.entries()) stored.push_back(entry.row);
        table_ = LeaseTable(stored, policy_, now_);
        owner_.clear();
        contact_.clear();
        for (const TaskRow& row : stored) {
            if (row.state != TaskState::Leased) continue;
            owner_[row.block] = row.worker;
            contact_[row.worker] = now_;
        }
    }

    void expire() {
        for (const std::string& task : table_.expire(now_)) {
            EXPECT_NE(table_.find(task)->row.state, TaskState::Leased);
        }
    }

    bool ended() const {
        return std::all_of(table_.entries().begin(), table_.entries().end(), [](const auto& entry) {
            return entry.row.state == TaskState::Done || entry.row.state == TaskState::Failed;
        });
    }

    void check() {
        expire();
        std::map<std::string, std::set<std::int64_t>> good;
        for (const Worker& worker : workers_) {
            if (!worker.lease) continue;
            if (table_.standing(*worker.lease) == CommitOutcome::Accepted) {
                good[worker.lease->task].insert(worker.lease->epoch);
            }
        }
        for (const auto& [task, epochs] : good) EXPECT_EQ(epochs.size(), 1U) << task;
        for (const auto& entry : table_.entries()) {
            EXPECT_LE(entry.row.failures, policy_.max_failures);
            EXPECT_LE(entry.row.losses, policy_.max_losses);
            EXPECT_GE(entry.row.losses, 0);
            EXPECT_EQ(entry.row.state == TaskState::Done, n_accepted_[entry.row.id] == 1);
            EXPECT_LE(n_accepted_[entry.row.id], 1);
        }
    }

    void check_end(const TaskRow& row) {
        if (row.state == TaskState::Done) return;
        EXPECT_EQ(row.state, TaskState::Failed) << row.id;
        EXPECT_TRUE(row.failures == policy_.max_failures || row.losses == policy_.max_losses);
        EXPECT_FALSE(row.error.empty());
    }

    std::mt19937 random_;
    LeasePolicy policy_{.ttl = kTtl};
    int n_blocks_;
    LeaseTable table_;
    Time now_ = kStart;
    std::int64_t epoch_ = 0;
    int n_hired_ = 0;
    std::vector<Worker> workers_;
    std::vector<LeaseRef> history_;
    std::map<std::string, std::int64_t> last_epoch_;  // by task
    std::map<std::string, int> n_accepted_;           // by task
    std::map<std::string, std::string> owner_;        // by block
    std::map<std::string, Time> contact_;             // by worker
};

TEST(LeaseTableSchedules, EveryTaskEndsOnceWhateverHappens) {
    for (unsigned seed = 0; seed < 200; ++seed) {
        SCOPED_TRACE("schedule " + std::to_string(seed));
        World world(seed);
        world.chaos();
        world.calm();
        if (testing::Test::HasFailure()) break;
    }
}

}  // namespace
}  // namespace misbench
