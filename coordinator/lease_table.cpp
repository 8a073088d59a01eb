#include "coordinator/lease_table.h"

#include <algorithm>
#include <utility>

#include "renderer/base/check.h"
#include "renderer/base/sha256.h"

namespace misbench {
namespace {

// Best first. A task that failed here waits for another worker while there is one, and any worker
// without work may take it out of a block that is not its own.
enum class Preference { OwnBlock, FreeBlock, FailedElsewhere, FailedHere };

}  // namespace

struct LeaseTable::Candidate {
    Preference preference;
    std::size_t idx;
    Block* block;
};

LeaseTable::LeaseTable(std::vector<TaskRow> rows, LeasePolicy policy, Time now) : policy_(policy) {
    std::stable_sort(rows.begin(), rows.end(),
                     [](const TaskRow& a, const TaskRow& b) { return a.position < b.position; });
    entries_.reserve(rows.size());
    for (TaskRow& row : rows) {
        const std::size_t idx = entries_.size();
        MISBENCH_CHECK(index_.emplace(row.id, idx).second);
        entries_.push_back({.row = std::move(row)});
        if (entries_[idx].row.state == TaskState::Leased) grant(idx, entries_[idx].row.worker, now);
    }
    make_blocks();
}

void LeaseTable::make_blocks() {
    std::unordered_map<std::string, std::size_t> known;
    std::vector<std::string> keys;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
        const TaskRow& row = entries_[i].row;
        keys.push_back(sha256_hex(std::to_string(policy_.order_seed) + '\n' + row.id));
        const auto [found, added] = known.emplace(row.block, blocks_.size());
        if (added) blocks_.emplace_back();
        Block& block = blocks_[found->second];
        block.order.push_back(i);
        if (row.state == TaskState::Leased) block.owner = row.worker;
    }
    for (Block& block : blocks_) {
        std::sort(block.order.begin(), block.order.end(),
                  [&](std::size_t a, std::size_t b) { return keys[a] < keys[b]; });
    }
}

bool LeaseTable::alive(const std::string& worker, Time now) const {
    const auto found = contact_.find(worker);
    return found != contact_.end() && now - found->second < policy_.ttl;
}

bool LeaseTable::alone(const std::string& worker, Time now) const {
    return std::none_of(contact_.begin(), contact_.end(), [&](const auto& other) {
        return other.first != worker && now - other.second < policy_.ttl;
    });
}

std::optional<LeaseRef> LeaseTable::acquire(const std::string& worker, Time now,
                                            const std::function<std::int64_t()>& next_epoch) {
    contact_[worker] = now;
    for (const std::size_t idx : leased_) {
        const TaskRow& row = entries_[idx].row;
        if (row.worker != worker) continue;
        entries_[idx].deadline = now + policy_.ttl;
        return LeaseRef{.task = row.id, .epoch = row.epoch};
    }
    const std::optional<Candidate> best = best_for(worker, now);
    if (!best) return std::nullopt;
    const std::int64_t epoch = next_epoch();
    TaskRow& row = entries_[best->idx].row;
    MISBENCH_CHECK(epoch > row.epoch);
    row.epoch = epoch;
    grant(best->idx, worker, now);
    if (best->preference != Preference::FailedElsewhere) best->block->owner = worker;
    return LeaseRef{.task = row.id, .epoch = epoch};
}

std::optional<LeaseTable::Candidate> LeaseTable::best_for(const std::string& worker, Time now) {
    const bool is_alone = alone(worker, now);
    std::optional<Candidate> best;
    for (Block& block : blocks_) {
        const bool mine = block.owner == worker;
        const bool open = mine || !alive(block.owner, now);
        for (const std::size_t idx : block.order) {
            const TaskRow& row = entries_[idx].row;
            if (row.state != TaskState::Pending) continue;
            Preference preference = mine ? Preference::OwnBlock : Preference::FreeBlock;
            if (row.failures > 0 && row.worker == worker) {
                if (!is_alone) continue;
                preference = Preference::FailedHere;
            } else if (!open) {
                if (row.failures == 0) continue;
                preference = Preference::FailedElsewhere;
            }
            if (!best || preference < best->preference) best = {preference, idx, &block};
            if (best->preference == Preference::OwnBlock) return best;
        }
    }
    return best;
}

void LeaseTable::grant(std::size_t idx, const std::string& worker, Time now) {
    Entry& entry = entries_[idx];
    entry.row.state = TaskState::Leased;
    entry.row.worker = worker;
    entry.granted = now;
    entry.deadline = now + policy_.ttl;
    entry.expired = false;
    leased_.insert(idx);
    contact_[worker] = now;
}

std::optional<std::size_t> LeaseTable::index(const std::string& task) const {
    const auto found = index_.find(task);
    if (found == index_.end()) return std::nullopt;
    return found->second;
}

const LeaseTable::Entry* LeaseTable::find(const std::string& task) const {
    const auto idx = index(task);
    return idx ? &entries_[*idx] : nullptr;
}

// The entry of a lease that may still be worked on, live again if it had expired.
std::optional<std::size_t> LeaseTable::holding(const LeaseRef& lease, Time now) {
    const auto idx = index(lease.task);
    if (!idx || entries_[*idx].row.epoch != lease.epoch) return std::nullopt;
    Entry& entry = entries_[*idx];
    if (entry.row.state != TaskState::Leased && !entry.expired) return std::nullopt;
    if (entry.expired) {
        --entry.row.losses;  // The worker was slow, not lost.
        entry.row.state = TaskState::Leased;
        entry.expired = false;
        leased_.insert(*idx);
    }
    entry.deadline = now + policy_.ttl;
    contact_[entry.row.worker] = now;
    return idx;
}

Renewal LeaseTable::renew(const LeaseRef& lease, Time now) {
    const Entry* entry = find(lease.task);
    const bool expired = entry != nullptr && entry->expired;
    if (!holding(lease, now)) return Renewal::Lost;
    return expired ? Renewal::Revived : Renewal::Renewed;
}

CommitOutcome LeaseTable::standing(const LeaseRef& lease) const {
    const Entry* entry = find(lease.task);
    if (entry == nullptr) return CommitOutcome::Stale;
    if (entry->row.state == TaskState::Done) return CommitOutcome::AlreadyDone;
    return entry->row.epoch == lease.epoch ? CommitOutcome::Accepted : CommitOutcome::Stale;
}

CommitOutcome LeaseTable::complete(const LeaseRef& lease, Time now) {
    const CommitOutcome outcome = standing(lease);
    if (outcome != CommitOutcome::Accepted) return outcome;
    const std::size_t idx = *index(lease.task);
    Entry& entry = entries_[idx];
    entry.row.state = TaskState::Done;
    entry.expired = false;
    leased_.erase(idx);
    contact_[entry.row.worker] = now;
    return outcome;
}

bool LeaseTable::fail(const LeaseRef& lease, const std::string& error, Time now) {
    const auto idx = holding(lease, now);
    if (!idx) return false;
    TaskRow& row = entries_[*idx].row;
    row.error = error;
    row.state = ++row.failures >= policy_.max_failures ? TaskState::Failed : TaskState::Pending;
    leased_.erase(*idx);
    return true;
}

bool LeaseTable::release(const LeaseRef& lease, Time now) {
    const auto idx = holding(lease, now);
    if (!idx) return false;
    entries_[*idx].row.state = TaskState::Pending;
    leased_.erase(*idx);
    return true;
}

void LeaseTable::depart(const std::string& worker) { contact_.erase(worker); }

std::vector<std::string> LeaseTable::expire(Time now) {
    std::erase_if(contact_, [&](const auto& worker) { return now - worker.second >= policy_.ttl; });
    std::vector<std::string> changed;
    for (auto it = leased_.begin(); it != leased_.end();) {
        Entry& entry = entries_[*it];
        if (entry.deadline > now) {
            ++it;
            continue;
        }
        TaskRow& row = entry.row;
        entry.expired = true;
        row.state = TaskState::Pending;
        if (++row.losses >= policy_.max_losses) {
            row.state = TaskState::Failed;
            row.error = std::to_string(row.losses) + " workers were lost while they worked on it";
        }
        changed.push_back(row.id);
        it = leased_.erase(it);
    }
    return changed;
}

}  // namespace misbench
