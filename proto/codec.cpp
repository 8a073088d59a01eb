#include "proto/codec.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "proto/limits.h"
#include "proto/queue.pb.h"
#include "renderer/base/error.h"

namespace misbench::wire {
namespace {

using std::chrono::milliseconds;

template <typename... Alternatives>
struct Overload : Alternatives... {
    using Alternatives::operator()...;
};
template <typename... Alternatives>
Overload(Alternatives...) -> Overload<Alternatives...>;

void require(bool condition, const std::string& what) {
    if (!condition) throw Error(Errc::InvalidArgument, "message refused: " + what);
}

bool is_hex(const std::string& text, std::size_t digits) {
    return text.size() == digits && std::all_of(text.begin(), text.end(), [](char c) {
               return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
           });
}

void require_artefact_name(const std::string& file) {
    const bool known =
        std::find(kArtefactNames.begin(), kArtefactNames.end(), file) != kArtefactNames.end() ||
        is_snapshot_file(file);
    require(known,
            "unknown artefact '" + file + "'; known: image.exr record.json snapshot-NUMBER.exr");
}

nlohmann::json parse(const std::string& text, const std::string& what) {
    try {
        return nlohmann::json::parse(text);
    } catch (const nlohmann::json::exception& e) {
        throw Error(Errc::InvalidArgument, "message refused: " + what + ": " + e.what());
    }
}

milliseconds duration(std::int64_t ms) {
    require(ms >= 0, "negative duration");
    return milliseconds(ms);
}

Instruction::Begin from_wire(const Work& work) {
    Instruction::Begin begin{.lease = from_wire(work.lease()),
                             .task = task_from_json(parse(work.task_json(), "task"))};
    require(task_id(begin.task) == begin.lease.task, "task whose id is not its lease's");
    return begin;
}

}  // namespace

// --- Lease -----------------------------------------------------------------------------------

Lease to_wire(const LeaseRef& lease) {
    Lease message;
    message.set_task(lease.task);
    message.set_epoch(lease.epoch);
    return message;
}

LeaseRef from_wire(const Lease& lease) {
    require(is_hex(lease.task(), kTaskIdDigits), "malformed task id '" + lease.task() + "'");
    require(lease.epoch() > 0, "epoch " + std::to_string(lease.epoch()) + " of a lease");
    return {.task = lease.task(), .epoch = lease.epoch()};
}

// --- Synchronize -----------------------------------------------------------------------------

SynchronizeRequest to_wire(const Call& call) {
    SynchronizeRequest message;
    message.set_worker(call.worker);
    message.set_build_id(call.build_id);
    message.set_leaving(call.report.leaving);
    std::visit(
        Overload{[&](const WorkerReport::Idle&) { message.mutable_idle(); },
                 [&](const WorkerReport::Working& working) {
                     *message.mutable_working() = to_wire(working.lease);
                 },
                 [&](const WorkerReport::Failed& failed) {
                     *message.mutable_failed()->mutable_lease() = to_wire(failed.lease);
                     message.mutable_failed()->set_error(failed.error.substr(0, kMaxErrorBytes));
                 },
                 [&](const WorkerReport::Released& released) {
                     *message.mutable_released() = to_wire(released.lease);
                 }},
        call.report.doing);
    return message;
}

Call from_wire(const SynchronizeRequest& request) {
    require(!request.worker().empty(), "worker without a name");
    require(request.worker().size() <= kMaxWorkerNameBytes, "worker's name is too long");
    Call call{.worker = request.worker(), .build_id = request.build_id(), .report = {}};
    call.report.leaving = request.leaving();
    switch (request.doing_case()) {
        case SynchronizeRequest::kIdle:
            call.report.doing = WorkerReport::Idle{};
            break;
        case SynchronizeRequest::kWorking:
            call.report.doing = WorkerReport::Working{from_wire(request.working())};
            break;
        case SynchronizeRequest::kFailed:
            require(request.failed().error().size() <= kMaxErrorBytes, "error text is too long");
            call.report.doing =
                WorkerReport::Failed{from_wire(request.failed().lease()), request.failed().error()};
            break;
        case SynchronizeRequest::kReleased:
            call.report.doing = WorkerReport::Released{from_wire(request.released())};
            break;
        case SynchronizeRequest::DOING_NOT_SET:
            throw Error(Errc::InvalidArgument, "message refused: worker does nothing known");
    }
    return call;
}

SynchronizeReply to_wire(const Instruction& instruction) {
    SynchronizeReply message;
    message.set_call_again_in_ms(instruction.call_again_in.count());
    std::visit(Overload{[&](const Instruction::Begin& begin) {
                            *message.mutable_work()->mutable_lease() = to_wire(begin.lease);
                            message.mutable_work()->set_task_json(task_to_json(begin.task).dump());
                        },
                        [&](const Instruction::GoOn& go_on) {
                            *message.mutable_go_on() = to_wire(go_on.lease);
                        },
                        [&](const Instruction::Stop& stop) {
                            *message.mutable_stop() = to_wire(stop.lease);
                        },
                        [&](const Instruction::Wait&) { message.mutable_wait(); },
                        [&](const Instruction::Exit&) { message.mutable_exit(); }},
               instruction.next);
    return message;
}

Instruction from_wire(const SynchronizeReply& reply) {
    Instruction instruction{.next = Instruction::Wait{},
                            .call_again_in = duration(reply.call_again_in_ms())};
    switch (reply.next_case()) {
        case SynchronizeReply::kWork:
            instruction.next = from_wire(reply.work());
            break;
        case SynchronizeReply::kGoOn:
            instruction.next = Instruction::GoOn{from_wire(reply.go_on())};
            break;
        case SynchronizeReply::kStop:
            instruction.next = Instruction::Stop{from_wire(reply.stop())};
            break;
        case SynchronizeReply::kWait:
            break;
        case SynchronizeReply::kExit:
            instruction.next = Instruction::Exit{};
            break;
        case SynchronizeReply::NEXT_NOT_SET:
            throw Error(Errc::InvalidArgument, "message refused: no known instruction");
    }
    return instruction;
}

// --- Upload and Commit -----------------------------------------------------------------------

UploadRequest to_wire(Chunk chunk) {
    UploadRequest message;
    *message.mutable_lease() = to_wire(chunk.lease);
    message.set_file(chunk.file);
    message.set_offset(chunk.offset);
    message.set_data(std::move(chunk.data));
    return message;
}

Chunk from_wire(const UploadRequest& request) {
    require_artefact_name(request.file());
    require(request.data().size() <= kMaxChunkBytes, "chunk is larger than 1 MiB");
    require(request.offset() >= 0 &&
                request.offset() <=
                    kMaxArtefactBytes - static_cast<std::int64_t>(request.data().size()),
            "offset " + std::to_string(request.offset()) + " of a chunk");
    return {.lease = from_wire(request.lease()),
            .file = request.file(),
            .offset = request.offset(),
            .data = request.data()};
}

CommitRequest to_wire(const Delivery& delivery) {
    CommitRequest message;
    *message.mutable_lease() = to_wire(delivery.lease);
    for (const QueueClient::Artefact& artefact : delivery.artefacts) {
        auto* added = message.add_artefacts();
        added->set_file(artefact.file);
        added->set_size(artefact.size);
        added->set_sha256(artefact.sha256);
    }
    return message;
}

Delivery from_wire(const CommitRequest& request) {
    Delivery delivery{.lease = from_wire(request.lease()), .artefacts = {}};
    for (const auto& artefact : request.artefacts()) {
        require_artefact_name(artefact.file());
        require(artefact.size() >= 0 && artefact.size() <= kMaxArtefactBytes,
                "size of '" + artefact.file() + "'");
        require(is_hex(artefact.sha256(), kSha256Digits), "SHA-256 of '" + artefact.file() + "'");
        delivery.artefacts.push_back(
            {.file = artefact.file(), .size = artefact.size(), .sha256 = artefact.sha256()});
    }
    return delivery;
}

CommitReply to_wire(CommitOutcome outcome) {
    CommitReply message;
    switch (outcome) {
        case CommitOutcome::Accepted:
            message.set_outcome(CommitReply::ACCEPTED);
            break;
        case CommitOutcome::Stale:
            message.set_outcome(CommitReply::STALE);
            break;
        case CommitOutcome::AlreadyDone:
            message.set_outcome(CommitReply::ALREADY_DONE);
            break;
    }
    return message;
}

CommitOutcome from_wire(const CommitReply& reply) {
    switch (reply.outcome()) {
        case CommitReply::ACCEPTED:
            return CommitOutcome::Accepted;
        case CommitReply::STALE:
            return CommitOutcome::Stale;
        case CommitReply::ALREADY_DONE:
            return CommitOutcome::AlreadyDone;
        default:
            break;
    }
    throw Error(Errc::InvalidArgument, "message refused: no known outcome of a commit");
}

// --- Submit and Status -----------------------------------------------------------------------

SubmitRequest to_wire(const Plan& plan) {
    SubmitRequest message;
    message.set_plan_json(plan_to_json(plan).dump());
    return message;
}

Plan from_wire(const SubmitRequest& request) {
    return plan_from_json(parse(request.plan_json(), "plan"));
}

SubmitReply to_wire(const SubmitResult& result) {
    SubmitReply message;
    message.set_tasks(result.tasks);
    message.set_cached(result.cached);
    return message;
}

SubmitResult from_wire(const SubmitReply& reply) {
    return {.tasks = reply.tasks(), .cached = reply.cached()};
}

StatusReply to_wire(const QueueStatus& status) {
    StatusReply message;
    message.set_pending(status.pending);
    message.set_leased(status.leased);
    message.set_done(status.done);
    message.set_failed(status.failed);
    for (const QueueStatus::Running& running : status.running) {
        auto* added = message.add_running();
        added->set_worker(running.worker);
        added->set_scene(running.scene);
        added->set_method(running.method);
        added->set_seed(running.seed);
        added->set_task(running.task);
        added->set_since_ms(running.since.count());
    }
    for (const QueueStatus::Failed& failed : status.failures) {
        auto* added = message.add_failures();
        added->set_task(failed.task);
        added->set_scene(failed.scene);
        added->set_method(failed.method);
        added->set_seed(failed.seed);
        added->set_error(failed.error);
    }
    for (const std::string& task : status.finished) message.add_finished(task);
    return message;
}

QueueStatus from_wire(const StatusReply& reply) {
    QueueStatus status{.pending = reply.pending(),
                       .leased = reply.leased(),
                       .done = reply.done(),
                       .failed = reply.failed(),
                       .running = {},
                       .failures = {},
                       .finished = {reply.finished().begin(), reply.finished().end()}};
    for (const auto& running : reply.running()) {
        status.running.push_back({.worker = running.worker(),
                                  .scene = running.scene(),
                                  .method = running.method(),
                                  .task = running.task(),
                                  .seed = running.seed(),
                                  .since = duration(running.since_ms())});
    }
    for (const auto& failed : reply.failures()) {
        status.failures.push_back({.task = failed.task(),
                                   .scene = failed.scene(),
                                   .method = failed.method(),
                                   .error = failed.error(),
                                   .seed = failed.seed()});
    }
    return status;
}

}  // namespace misbench::wire
