// Between our values and the wire's messages. from_wire() believes nothing: it throws
// InvalidArgument for whatever a correct peer would not send.
#pragma once

#include <string>
#include <vector>

#include "experiments/plan/experiment.h"
#include "proto/client.h"

namespace misbench::wire {

class CommitReply;
class CommitRequest;
class Lease;
class StatusReply;
class SubmitReply;
class SubmitRequest;
class SynchronizeReply;
class SynchronizeRequest;
class UploadRequest;

// Who calls, with which program, to report what.
struct Call {
    std::string worker;
    std::string build_id;
    WorkerReport report;
};

// A piece of an artefact.
struct Chunk {
    LeaseRef lease;
    std::string file;
    std::int64_t offset = 0;
    std::string data;
};

struct Delivery {
    LeaseRef lease;
    std::vector<QueueClient::Artefact> artefacts;
};

Lease to_wire(const LeaseRef& lease);
SynchronizeRequest to_wire(const Call& call);
SynchronizeReply to_wire(const Instruction& instruction);
UploadRequest to_wire(Chunk chunk);
CommitRequest to_wire(const Delivery& delivery);
CommitReply to_wire(CommitOutcome outcome);
SubmitRequest to_wire(const Plan& plan);
SubmitReply to_wire(const SubmitResult& result);
StatusReply to_wire(const QueueStatus& status);

LeaseRef from_wire(const Lease& lease);
Call from_wire(const SynchronizeRequest& request);
Instruction from_wire(const SynchronizeReply& reply);
Chunk from_wire(const UploadRequest& request);
Delivery from_wire(const CommitRequest& request);
CommitOutcome from_wire(const CommitReply& reply);
Plan from_wire(const SubmitRequest& request);
SubmitResult from_wire(const SubmitReply& reply);
QueueStatus from_wire(const StatusReply& reply);

}  // namespace misbench::wire
