// Files that are there whole or not at all, and a lock that dies with its process.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace misbench {

// The bytes of a file. Throws NotFound when there is none, DataLoss when it cannot be read.
std::string read_file(const std::filesystem::path& path);

// Writes by temporary name, fsync and rename, then fsync of the folder: after a crash the file has
// its old bytes or its new ones. Throws DataLoss with the system's reason (disk full, read-only).
void write_file_durably(const std::filesystem::path& path, std::string_view bytes);

// fsync of a file or folder.
void sync_path(const std::filesystem::path& path);

// Moves a complete folder to its final name: fsync of its files and itself, rename, fsync of the
// parent. REQUIRES: `to` does not exist; both on one file system.
void publish_folder(const std::filesystem::path& from, const std::filesystem::path& to);

// An exclusive lock (flock) on a file that is created if needed, held for this object's life.
// Throws FailedPrecondition "store '…' is in use by process 123" when another process has it.
class FileLock {
 public:
    explicit FileLock(const std::filesystem::path& path);
    ~FileLock();
    FileLock(const FileLock&) = delete;
    FileLock& operator=(const FileLock&) = delete;

 private:
    int descriptor_;
};

}  // namespace misbench
