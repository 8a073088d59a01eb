// Our errors as gRPC's status codes, and back: one table, so that both ways agree.
#pragma once

#include <grpcpp/support/status.h>

#include <exception>
#include <utility>

#include "renderer/base/error.h"

namespace misbench::wire {

grpc::Status to_status(const Error& error);
// REQUIRES: !status.ok(). A status that is none of ours says that nobody of ours answered:
// Unavailable for the transport's own codes, Internal for the rest.
Error to_error(const grpc::Status& status);

// The body of a handler: nothing may be thrown into gRPC.
template <typename Body>
grpc::Status guarded(Body&& body) {
    try {
        std::forward<Body>(body)();
        return grpc::Status::OK;
    } catch (const Error& error) {
        return to_status(error);
    } catch (const std::exception& error) {
        return to_status(Error(Errc::Internal, error.what()));
    }
}

}  // namespace misbench::wire
