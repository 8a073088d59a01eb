// The names and sizes that the protocol allows, for both sides of the wire.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace misbench {

// What a result consists of, beside its snapshots (snapshot_file()); no other file is taken.
inline constexpr std::array<std::string_view, 2> kArtefactNames{"image.exr", "record.json"};
inline constexpr std::size_t kTaskIdDigits = 32;
inline constexpr std::size_t kSha256Digits = 64;

inline constexpr std::size_t kMaxChunkBytes = std::size_t{1} << 20U;
// A plan travels in one message: 64 MiB are about 90 000 cells.
inline constexpr int kMaxMessageBytes = 64 << 20;
inline constexpr std::int64_t kMaxArtefactBytes = std::int64_t{1} << 30;
inline constexpr std::size_t kMaxWorkerNameBytes = 256;
inline constexpr std::size_t kMaxErrorBytes = 4096;
// sockaddr_un holds 108 bytes with the terminator; a longer path would be cut without a word.
inline constexpr std::size_t kMaxUnixPathBytes = 107;

}  // namespace misbench
