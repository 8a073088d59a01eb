#include "proto/client.h"

#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <thread>
#include <utility>

#include "proto/address.h"
#include "proto/codec.h"
#include "proto/limits.h"
#include "proto/queue.grpc.pb.h"
#include "proto/status.h"

namespace misbench {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kFirstReconnect{50};
constexpr milliseconds kLastReconnect{1000};
constexpr milliseconds kPauseBetweenTries{50};
// The coordinator may lose what it has of a file by a restart, but not for ever.
constexpr int kMaxUploadRestarts = 3;

std::shared_ptr<grpc::Channel> connect(const std::string& address) {
    check_address("connect to", address);
    grpc::ChannelArguments arguments;
    arguments.SetMaxSendMessageSize(kMaxMessageBytes);
    arguments.SetMaxReceiveMessageSize(kMaxMessageBytes);
    // gRPC would wait up to two minutes before it looks for a restarted coordinator.
    arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS,
                     static_cast<int>(kFirstReconnect.count()));
    arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, static_cast<int>(kFirstReconnect.count()));
    arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, static_cast<int>(kLastReconnect.count()));
    // A proxy of the environment is not meant for a coordinator, least of all on this machine.
    arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
    return grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
}

}  // namespace

struct QueueClient::Connection {
    std::string address;
    milliseconds deadline;
    std::unique_ptr<wire::Queue::Stub> stub;

    // A call that broke off is made again until the deadline: all calls of the protocol may be.
    template <typename Reply, typename Request>
    Reply call(grpc::Status (wire::Queue::Stub::*method)(grpc::ClientContext*, const Request&,
                                                         Reply*),
               const Request& request) {
        const auto end = steady_clock::now() + deadline;
        while (true) {
            grpc::ClientContext context;
            context.set_wait_for_ready(true);
            context.set_deadline(std::chrono::system_clock::now() +
                                 std::chrono::duration_cast<std::chrono::system_clock::duration>(
                                     end - steady_clock::now()));
            Reply reply;
            const grpc::Status status = (stub.get()->*method)(&context, request, &reply);
            if (status.ok()) return reply;
            const Error error = wire::to_error(status);
            if (error.code() != Errc::Unavailable) throw error;
            if (steady_clock::now() + kPauseBetweenTries >= end) {
                throw Error(Errc::Unavailable, "call coordinator at '" + address +
                                                   "': no answer within " +
                                                   std::to_string(deadline.count()) + " ms");
            }
            std::this_thread::sleep_for(kPauseBetweenTries);
        }
    }
};

QueueClient::QueueClient(const std::string& address, milliseconds deadline)
    : connection_(std::make_unique<Connection>(
          Connection{address, deadline, wire::Queue::NewStub(connect(address))})) {}
QueueClient::~QueueClient() = default;
QueueClient::QueueClient(QueueClient&&) noexcept = default;

SubmitResult QueueClient::submit(const Plan& plan) {
    const wire::SubmitRequest request = wire::to_wire(plan);
    if (request.ByteSizeLong() > std::size_t{kMaxMessageBytes}) {
        throw Error(Errc::InvalidArgument,
                    "submit experiment '" + plan.experiment + "': its plan has " +
                        std::to_string(request.ByteSizeLong()) + " bytes; at most " +
                        std::to_string(kMaxMessageBytes));
    }
    return wire::from_wire(connection_->call(&wire::Queue::Stub::Submit, request));
}

QueueStatus QueueClient::status(const std::string& experiment) {
    wire::StatusRequest request;
    request.set_experiment(experiment);
    return wire::from_wire(connection_->call(&wire::Queue::Stub::Status, request));
}

Instruction QueueClient::synchronize(const std::string& worker, const std::string& build_id,
                                     const WorkerReport& report) {
    const wire::Call call{.worker = worker, .build_id = build_id, .report = report};
    return wire::from_wire(connection_->call(&wire::Queue::Stub::Synchronize, wire::to_wire(call)));
}

void QueueClient::upload(const LeaseRef& lease, const std::string& file, const std::string& bytes) {
    std::size_t sent = 0;
    int restarts = 0;
    do {
        wire::Chunk chunk{.lease = lease,
                          .file = file,
                          .offset = static_cast<std::int64_t>(sent),
                          .data = bytes.substr(sent, kMaxChunkBytes)};
        const wire::UploadReply reply =
            connection_->call(&wire::Queue::Stub::Upload, wire::to_wire(std::move(chunk)));
        const auto there = static_cast<std::size_t>(std::max<std::int64_t>(reply.size(), 0));
        if (there <= sent && there < bytes.size() && ++restarts > kMaxUploadRestarts) {
            throw Error(Errc::DataLoss, "upload '" + file + "' of task " + lease.task +
                                            ": the coordinator keeps only " +
                                            std::to_string(there) + " bytes of it");
        }
        sent = there;
    } while (sent < bytes.size());
}

CommitOutcome QueueClient::commit(const LeaseRef& lease, const std::vector<Artefact>& artefacts) {
    const wire::Delivery delivery{.lease = lease, .artefacts = artefacts};
    return wire::from_wire(connection_->call(&wire::Queue::Stub::Commit, wire::to_wire(delivery)));
}

}  // namespace misbench
