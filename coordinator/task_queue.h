// The coordinator without its sockets: the lease table joined to the store. Whatever a worker is
// told is on disk before it is told, so that a coordinator that dies at any point is continued by
// the next one on the same store. Time is an argument here too.
//
// Thread-safe: one mutex around everything. Disk writes happen under it, because a grant, a commit
// and their rows are one step.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "coordinator/lease_table.h"
#include "proto/client.h"
#include "results/store.h"

namespace misbench {

class TaskQueue {
 public:
    using Time = LeaseTable::Time;

    TaskQueue(Store store, LeasePolicy policy, Time now);

    SubmitResult submit(const Plan& plan, Time now);
    // `experiment` "" covers all tasks. Throws NotFound for one that the store does not have.
    QueueStatus status(const std::string& experiment, Time now);

    // Throws FailedPrecondition when the worker is of another build: its numbers might differ.
    Instruction synchronize(const std::string& worker, const std::string& build_id,
                            const WorkerReport& report, Time now);
    // Appends a chunk if it begins where the file ends here. Returns the size of the file here,
    // where the worker goes on. Throws FailedPrecondition when the lease is lost.
    std::int64_t upload(const LeaseRef& lease, const std::string& file, std::int64_t offset,
                        std::string_view data, Time now);
    // Throws DataLoss, and forgets what was uploaded, when that is not what the worker announces.
    CommitOutcome commit(const LeaseRef& lease, const std::vector<QueueClient::Artefact>& artefacts,
                         Time now);

 private:
    // Where the artefacts of a lease arrive. Not stored: after a restart they are sent again.
    struct Upload {
        std::int64_t epoch = 0;
        std::filesystem::path folder;
    };
    using Labels = std::unordered_map<std::string, std::string>;  // task id → method's label

    // A caller may read the clock, wait for the mutex, and come in after one who read it later.
    Time advance(Time now);
    void save(const std::string& task);
    void expire(Time now);
    Renewal renew(const LeaseRef& lease, Time now);
    Instruction next_for(const std::string& worker, Time now);
    const std::filesystem::path& folder_of(const LeaseRef& lease);
    void forget_upload(const std::string& task);
    void verify(const LeaseRef& lease, const std::vector<QueueClient::Artefact>& artefacts,
                const std::filesystem::path& folder) const;
    const Labels& labels(const std::string& experiment);

    std::mutex mutex_;
    Store store_;
    LeaseTable table_;
    Time latest_;
    std::map<std::string, Upload> uploads_;  // by task
    std::map<std::string, Labels> labels_;   // by experiment
    std::vector<std::string> finished_;      // task ids, in order
};

}  // namespace misbench
