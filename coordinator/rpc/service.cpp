#include "coordinator/rpc/service.h"

#include <grpcpp/grpcpp.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <chrono>
#include <utility>

#include "proto/address.h"
#include "proto/codec.h"
#include "proto/limits.h"
#include "proto/queue.grpc.pb.h"
#include "proto/status.h"

namespace misbench {
namespace {

using std::chrono::steady_clock;

constexpr std::chrono::seconds kShutdownGrace{2};

// gRPC removes whatever socket it finds at a path: one that a crash left, but also one in use.
bool somebody_listens_at(const std::string& path) {
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    path.copy(name.sun_path, sizeof name.sun_path - 1);
    const int descriptor = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const bool connected =
        ::connect(descriptor, reinterpret_cast<const sockaddr*>(&name), sizeof name) == 0;
    ::close(descriptor);
    return connected;
}

template <typename Body>
grpc::ServerUnaryReactor* answer(grpc::CallbackServerContext* context, Body&& body) {
    grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
    reactor->Finish(wire::guarded(std::forward<Body>(body)));
    return reactor;
}

class QueueService final : public wire::Queue::CallbackService {
 public:
    explicit QueueService(TaskQueue& queue) : queue_(queue) {}

    grpc::ServerUnaryReactor* Synchronize(grpc::CallbackServerContext* context,
                                          const wire::SynchronizeRequest* request,
                                          wire::SynchronizeReply* reply) override {
        return answer(context, [&] {
            const wire::Call call = wire::from_wire(*request);
            *reply = wire::to_wire(
                queue_.synchronize(call.worker, call.build_id, call.report, steady_clock::now()));
        });
    }

    grpc::ServerUnaryReactor* Upload(grpc::CallbackServerContext* context,
                                     const wire::UploadRequest* request,
                                     wire::UploadReply* reply) override {
        return answer(context, [&] {
            const wire::Chunk chunk = wire::from_wire(*request);
            reply->set_size(queue_.upload(chunk.lease, chunk.file, chunk.offset, chunk.data,
                                          steady_clock::now()));
        });
    }

    grpc::ServerUnaryReactor* Commit(grpc::CallbackServerContext* context,
                                     const wire::CommitRequest* request,
                                     wire::CommitReply* reply) override {
        return answer(context, [&] {
            const wire::Delivery delivery = wire::from_wire(*request);
            *reply = wire::to_wire(
                queue_.commit(delivery.lease, delivery.artefacts, steady_clock::now()));
        });
    }

    grpc::ServerUnaryReactor* Submit(grpc::CallbackServerContext* context,
                                     const wire::SubmitRequest* request,
                                     wire::SubmitReply* reply) override {
        return answer(context, [&] {
            *reply = wire::to_wire(queue_.submit(wire::from_wire(*request), steady_clock::now()));
        });
    }

    grpc::ServerUnaryReactor* Status(grpc::CallbackServerContext* context,
                                     const wire::StatusRequest* request,
                                     wire::StatusReply* reply) override {
        return answer(context, [&] {
            *reply = wire::to_wire(queue_.status(request->experiment(), steady_clock::now()));
        });
    }

 private:
    TaskQueue& queue_;
};

}  // namespace

struct QueueServer::Listening {
    explicit Listening(TaskQueue& queue) : service(queue) {}
    QueueService service;
    std::unique_ptr<grpc::Server> server;
};

QueueServer::QueueServer(TaskQueue& queue, const std::string& address)
    : listening_(std::make_unique<Listening>(queue)), address_(address) {
    check_address("listen on", address);
    const auto refuse = [&] {
        throw Error(Errc::FailedPrecondition,
                    "listen on '" + address + "': the address is taken or not of this machine");
    };
    if (is_unix_address(address) && somebody_listens_at(unix_path(address))) refuse();
    int port = 0;
    grpc::ServerBuilder builder;
    builder.AddListeningPort(address, grpc::InsecureServerCredentials(), &port);
    builder.SetMaxReceiveMessageSize(kMaxMessageBytes);
    builder.SetMaxSendMessageSize(kMaxMessageBytes);
    // Otherwise two coordinators could share a port, and each get half of the calls.
    builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
    builder.RegisterService(&listening_->service);
    listening_->server = builder.BuildAndStart();
    if (listening_->server == nullptr || port == 0) refuse();
    if (!is_unix_address(address))
        address_ = address.substr(0, address.rfind(':')) + ":" + std::to_string(port);
}

QueueServer::~QueueServer() {
    listening_->server->Shutdown(std::chrono::system_clock::now() + kShutdownGrace);
    listening_->server->Wait();
}

}  // namespace misbench
