// Factors in front of a weight, one provider each: w_s = (γ ⊙ h(c ⊙ q))_s over the sum of all, with
// the effective densities q and a heuristic's shares h (renderer/mis/heuristics.h). The extended
// balance heuristic is grittmann2022 Eq. 2.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "renderer/image/image.h"
#include "renderer/methods/method.h"
#include "renderer/paths/sample.h"

namespace misbench {

class ThreadPool;

class FactorProvider {
 public:
    // What a factor multiplies. Both are the same to the balance heuristic; a power of it would
    // raise a factor of densities too.
    enum class Place : std::uint8_t { Densities, Shares };

    virtual ~FactorProvider() = default;
    virtual Place place() const { return Place::Densities; }
    // Multiplies c_t > 0 into the factors, by index of technique. Called from many threads.
    virtual void multiply(const PathView& path, const TechniqueCounts& counts,
                          std::span<double> factors) const = 0;

    // ---- Of those that learn from passes: what they find is used from the next pass on, never in
    // the one that it was learned from.

    virtual void start(const Scene& /*scene*/, FrameInfo /*frame*/) {}
    // Watches a pass of training; null: does not learn.
    virtual SampleObserver* trainer() { return nullptr; }
    // It watches every pass: none can learn on top of it.
    virtual bool never_stops_learning() const { return false; }
    // Serial, after each pass that it watched. `is_last` says that there will not be another.
    virtual Forgotten finish_pass(ThreadPool& /*threads*/, bool /*is_last*/) { return {}; }
    // For the record: adds keys.
    virtual void describe(nlohmann::json& /*json*/) const {}
    // The factors by pixel, alike in all channels: "correction.merge".
    virtual std::vector<NamedImage> maps() const { return {}; }
};

}  // namespace misbench
