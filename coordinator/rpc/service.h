// The queue's gRPC face: listens from construction to destruction.
#pragma once

#include <memory>
#include <string>

#include "coordinator/task_queue.h"

namespace misbench {

class QueueServer {
 public:
    // "unix:/path" or "host:port", port 0 for any. Throws InvalidArgument for an address that
    // cannot be, FailedPrecondition when it is taken. `queue` outlives the server.
    QueueServer(TaskQueue& queue, const std::string& address);
    ~QueueServer();
    QueueServer(const QueueServer&) = delete;
    QueueServer& operator=(const QueueServer&) = delete;

    // As given, with the real port.
    const std::string& address() const { return address_; }

 private:
    struct Listening;
    std::unique_ptr<Listening> listening_;
    std::string address_;
};

}  // namespace misbench
