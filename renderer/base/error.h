// How an operation says that it failed: one exception type with a code. Caught in three places
// only: main() (exit code), the rpc adapters (grpc::Status), the worker's task runner (failed run).
#pragma once

#include <stdexcept>
#include <string>

namespace misbench {

enum class Errc {
    InvalidArgument,     // what the user wrote cannot be: an unknown name, a broken scene file
    NotFound,            // a file, scene, run or experiment that is not there
    FailedPrecondition,  // the store is in use, read-only, or of another version
    Unavailable,         // the coordinator does not answer
    DataLoss,            // stored bytes are damaged, or could not be written
    Internal,            // a bug of ours that did not need to abort
};

// The message is one line: what was attempted, what was found, what is known.
class Error : public std::runtime_error {
 public:
    Error(Errc code, const std::string& message) : std::runtime_error(message), code_(code) {}
    Errc code() const noexcept { return code_; }

 private:
    Errc code_;
};

// A bad value or name of one parameter, so that a caller who knows where `key` was written can add
// the place. `key` is "" where the error is not about one parameter.
class ParameterError : public Error {
 public:
    ParameterError(std::string key, const std::string& message)
        : Error(Errc::InvalidArgument, message), key_(std::move(key)) {}
    const std::string& key() const noexcept { return key_; }

 private:
    std::string key_;
};

// The exit code of a program that ends with this error: 2 for what the user wrote, 3 for the store,
// 4 for a coordinator that does not answer, 70 for a bug of ours.
int exit_code(Errc code);

}  // namespace misbench
