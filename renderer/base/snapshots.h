// Snapshots: the image of a render on its way. After N passes it is, bit for bit, what a render
// with a budget of N samples gives, and says at which cost it was there.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace misbench {

// A snapshot after `first` passes, then each time after `factor` times as many.
struct SnapshotLadder {
    std::int64_t first = 1;
    std::int64_t factor = 2;  // at least 2
    bool operator==(const SnapshotLadder&) const = default;
};

// Whether one is due after so many passes, at least 1.
inline bool is_rung(const SnapshotLadder& ladder, std::int64_t passes) {
    if (passes % ladder.first != 0) return false;
    std::int64_t rest = passes / ladder.first;
    while (rest % ladder.factor == 0) rest /= ladder.factor;
    return rest == 1;
}

// Named as in RenderStatistics, and up to here.
struct SnapshotStatistics {
    std::int64_t samples = 0;  // passes rendered: the sample budget that ends here
    std::int64_t passes = 0;   // those in the image
    double wall_seconds = 0;
    double cpu_seconds = 0;
    std::int64_t training_passes = 0;
    double training_wall_seconds = 0;
    double training_cpu_seconds = 0;
    std::int64_t rays = 0;
    bool operator==(const SnapshotStatistics&) const = default;
};

// The name of a snapshot's image beside that of its run: "snapshot-000064.exr".
std::string snapshot_file(std::int64_t samples);
bool is_snapshot_file(std::string_view name);

}  // namespace misbench
