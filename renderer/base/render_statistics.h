// What the render loop measured about one run. Filled by the renderer, stored with the record.
#pragma once

#include <cstdint>
#include <optional>

#include "renderer/base/budget.h"

namespace misbench {

// A run of fewer passes is marked wherever it is shown under a time budget: discarding the pass in
// flight biases the mean by an amount that is negligible only beyond it (simulated: -0.2 % at ten
// passes, -12.7 % at three).
inline constexpr std::int64_t kFewPasses = 10;
inline bool has_few_passes(const Budget& budget, std::int64_t passes) {
    // None at all: of an image of another renderer it is not known, any other such run is invalid.
    return std::holds_alternative<TimeBudget>(budget) && passes > 0 && passes < kFewPasses;
}

// Enough to render one sample again.
struct SamplePlace {
    int x = 0;
    int y = 0;
    std::int64_t pass = 0;
    bool operator==(const SamplePlace&) const = default;
};

struct RenderStatistics {
    std::int64_t passes = 0;  // completed and counted passes = samples a pixel
    int threads = 0;
    double load_seconds = 0;   // wall: scene file to description
    double build_seconds = 0;  // wall: BVH and light tables
    double wall_seconds = 0;   // counted passes, steady clock
    double cpu_seconds = 0;    // counted passes, summed over the render threads
    // Passes that trained the method, in the image or not; a part of the counted seconds above.
    std::int64_t training_passes = 0;
    double training_wall_seconds = 0;
    double training_cpu_seconds = 0;
    // The same before the image was begun, outside of the budget and of all other numbers.
    std::int64_t precomputed_passes = 0;
    double precomputed_wall_seconds = 0;
    double precomputed_cpu_seconds = 0;
    double discarded_wall_seconds = 0;  // the pass in flight when the time budget ended
    double discarded_cpu_seconds = 0;
    std::int64_t rays = 0;  // closest-hit and shadow rays of counted passes
    std::int64_t nonfinite_samples = 0;
    std::int64_t negative_samples = 0;
    std::optional<SamplePlace> first_bad_sample;  // in order of (pass, row, column)
    // What a neighbour on the machine did meanwhile.
    std::int64_t involuntary_context_switches = 0;
    double steal_seconds = 0;  // /proc/stat, whole machine
    std::int64_t peak_memory_bytes = 0;

    bool operator==(const RenderStatistics&) const = default;
};

}  // namespace misbench
