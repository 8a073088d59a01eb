#include "renderer/base/files.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "renderer/base/error.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void throw_errno(Errc code, const std::string& attempt, const fs::path& path) {
    const int error = errno;
    throw Error(code, attempt + " '" + path.string() + "': " + std::strerror(error));
}

// Closes on every way out; close() errors are reported where they matter, before this.
struct Descriptor {
    int value;
    ~Descriptor() {
        if (value >= 0) ::close(value);
    }
};

void write_all(int descriptor, std::string_view bytes, const fs::path& path) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) throw_errno(Errc::DataLoss, "write", path);
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
}

}  // namespace

std::string read_file(const fs::path& path) {
    std::error_code ignored;
    if (!fs::is_regular_file(path, ignored)) {
        throw Error(Errc::NotFound, "read '" + path.string() + "': no such file");
    }
    std::ifstream in(path, std::ios::binary);
    std::string bytes(fs::file_size(path), '\0');
    in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!in) throw Error(Errc::DataLoss, "read '" + path.string() + "': input error");
    return bytes;
}

void sync_path(const fs::path& path) {
    const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
    if (file.value < 0 || ::fsync(file.value) != 0) throw_errno(Errc::DataLoss, "sync", path);
}

void write_file_durably(const fs::path& path, std::string_view bytes) {
    fs::path temporary = path;
    temporary += ".tmp" + std::to_string(::getpid());
    try {
        const Descriptor file{
            ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)};
        if (file.value < 0) throw_errno(Errc::DataLoss, "create", temporary);
        write_all(file.value, bytes, temporary);
        if (::fsync(file.value) != 0) throw_errno(Errc::DataLoss, "sync", temporary);
        if (::rename(temporary.c_str(), path.c_str()) != 0) {
            throw_errno(Errc::DataLoss, "rename to", path);
        }
    } catch (...) {
        ::unlink(temporary.c_str());
        throw;
    }
    sync_path(path.has_parent_path() ? path.parent_path() : fs::path("."));
}

void publish_folder(const fs::path& from, const fs::path& to) {
    for (const auto& entry : fs::directory_iterator(from)) sync_path(entry.path());
    sync_path(from);
    if (::rename(from.c_str(), to.c_str()) != 0) throw_errno(Errc::DataLoss, "rename to", to);
    sync_path(to.parent_path());
}

FileLock::FileLock(const fs::path& path)
    : descriptor_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
    if (descriptor_ < 0) throw_errno(Errc::FailedPrecondition, "open lock", path);
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
        char holder[32] = {};
        const ssize_t size = ::pread(descriptor_, holder, sizeof holder - 1, 0);
        ::close(descriptor_);
        throw Error(Errc::FailedPrecondition,
                    "store '" + path.parent_path().string() + "' is in use by process " +
                        std::string(holder, size > 0 ? static_cast<std::size_t>(size) : 0));
    }
    const std::string pid = std::to_string(::getpid());
    if (::ftruncate(descriptor_, 0) != 0 ||
        ::pwrite(descriptor_, pid.data(), pid.size(), 0) != static_cast<ssize_t>(pid.size())) {
        ::close(descriptor_);
        throw_errno(Errc::FailedPrecondition, "write lock", path);
    }
}

FileLock::~FileLock() { ::close(descriptor_); }

}  // namespace misbench
