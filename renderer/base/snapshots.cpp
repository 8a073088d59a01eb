#include "renderer/base/snapshots.h"

#include <algorithm>
#include <limits>

namespace misbench {
namespace {

constexpr std::string_view kStem = "snapshot-";
constexpr std::string_view kEnding = ".exr";
constexpr std::size_t kFewestDigits = 6;

}  // namespace

std::string snapshot_file(std::int64_t samples) {
    std::string digits = std::to_string(samples);
    if (digits.size() < kFewestDigits) digits.insert(0, kFewestDigits - digits.size(), '0');
    return std::string(kStem) + digits + std::string(kEnding);
}

bool is_snapshot_file(std::string_view name) {
    if (!name.starts_with(kStem) || !name.ends_with(kEnding)) return false;
    name.remove_prefix(kStem.size());
    if (name.size() < kFewestDigits + kEnding.size()) return false;
    name.remove_suffix(kEnding.size());
    return name.size() <= std::numeric_limits<std::int64_t>::digits10 + 1 &&
           std::ranges::all_of(name, [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace misbench
