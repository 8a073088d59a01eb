#include "proto/status.h"

#include <algorithm>
#include <array>

namespace misbench::wire {
namespace {

struct Row {
    Errc ours;
    grpc::StatusCode theirs;
};

constexpr std::array kCodes{
    Row{Errc::InvalidArgument, grpc::StatusCode::INVALID_ARGUMENT},
    Row{Errc::NotFound, grpc::StatusCode::NOT_FOUND},
    Row{Errc::FailedPrecondition, grpc::StatusCode::FAILED_PRECONDITION},
    Row{Errc::Unavailable, grpc::StatusCode::UNAVAILABLE},
    Row{Errc::DataLoss, grpc::StatusCode::DATA_LOSS},
    Row{Errc::Internal, grpc::StatusCode::INTERNAL},
};

}  // namespace

grpc::Status to_status(const Error& error) {
    const auto* row = std::find_if(kCodes.begin(), kCodes.end(),
                                   [&](const Row& r) { return r.ours == error.code(); });
    return {row->theirs, error.what()};
}

Error to_error(const grpc::Status& status) {
    const grpc::StatusCode code = status.error_code();
    const auto* row =
        std::find_if(kCodes.begin(), kCodes.end(), [&](const Row& r) { return r.theirs == code; });
    if (row != kCodes.end()) return {row->ours, status.error_message()};
    const bool no_answer =
        code == grpc::StatusCode::DEADLINE_EXCEEDED || code == grpc::StatusCode::CANCELLED;
    return {no_answer ? Errc::Unavailable : Errc::Internal, status.error_message()};
}

}  // namespace misbench::wire
