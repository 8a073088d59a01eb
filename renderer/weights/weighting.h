// The weights of a method's samples, and everybody who watches them: an observer from outside, and
// the factors that are learned while the image is rendered.
#pragma once

#include <algorithm>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "renderer/paths/path_weights.h"
#include "renderer/weights/parameters.h"

namespace misbench {

// Factors are learned one after the other, each on top of those before it, in passes of training of
// its own: the first passes of the image, or precomputed ones.
class Weighting {
 public:
    explicit Weighting(const WeightParameters& parameters,
                       DensityPrecision precision = DensityPrecision::Double);

    // As Method's.
    void attach(SampleObserver& observer) { observer_ = &observer; }
    void start(const Scene& scene, FrameInfo frame);
    Forgotten finish_pass(ThreadPool& threads);
    std::int64_t n_precomputed_passes() const;
    bool is_training() const;
    bool learns() const {
        return !learners_.empty() && (!is_precomputed_ || learners_.back()->never_stops_learning());
    }
    void describe(nlohmann::json& json) const;
    std::vector<NamedImage> maps() const;

    // Before a pass: who watches it. No factor is learned from a pass that does not train; there is
    // no finish_pass() after it.
    void start_pass(bool trains = true);
    bool is_watched() const { return !observers_.empty(); }
    bool wants_zeros() const { return wants_zeros_; }
    void start_phase(std::size_t n_chunks) const;
    void finish_phase() const;

    // The weight of a sample, which all that watch are shown: scale · value is what the pixel would
    // gain with weight 1. A technique without alternatives has all of the weight.
    double weigh(const PathView& path, const TechniqueCounts& counts, Technique technique,
                 bool has_alternatives, Rgb value, double scale, std::size_t chunk,
                 PathWeights::Scratch& scratch) const {
        const PathWeights::Weight weight = has_alternatives
                                               ? weights_.weigh(path, counts, technique, scratch)
                                               : PathWeights::Weight{.w = 1};
        if (is_watched()) [[unlikely]] {
            show({.path = path,
                  .technique = technique,
                  .value = static_cast<float>(scale) * value,
                  .weight = weight.w,
                  .q = weight.q,
                  .factors = weight.factors,
                  .weights = weight.weights},
                 chunk);
        }
        return weight.w;
    }

 private:
    void show(const Sample& sample, std::size_t chunk) const;
    // Who learns from the pass.
    FactorProvider& learner() const {
        const auto turn = static_cast<std::size_t>(n_passes_ / passes_of_each_);
        return *learners_[std::min(turn, learners_.size() - 1)];
    }

    PathWeights weights_;
    std::vector<std::shared_ptr<FactorProvider>> providers_;
    std::vector<FactorProvider*> learners_;  // of them, in order
    std::int64_t passes_of_each_;
    bool is_precomputed_;

    SampleObserver* observer_ = nullptr;
    std::int64_t n_passes_ = 0;               // done
    std::vector<SampleObserver*> observers_;  // of this pass
    bool wants_zeros_ = false;
};

}  // namespace misbench
