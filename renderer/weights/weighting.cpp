#include "renderer/weights/weighting.h"

namespace misbench {

Weighting::Weighting(const WeightParameters& parameters, DensityPrecision precision)
    : weights_(Heuristic::parse(parameters.mis), precision),
      providers_(make_factors(parameters)),
      passes_of_each_(parameters.precompute > 0 ? parameters.precompute : parameters.training),
      is_precomputed_(parameters.precompute > 0) {
    for (const auto& provider : providers_) {
        weights_.add(provider);
        if (provider->trainer() != nullptr) learners_.push_back(provider.get());
    }
}

void Weighting::start(const Scene& scene, FrameInfo frame) {
    for (const auto& provider : providers_) provider->start(scene, frame);
}

std::int64_t Weighting::n_precomputed_passes() const {
    return is_precomputed_ ? passes_of_each_ * static_cast<std::int64_t>(learners_.size()) : 0;
}

bool Weighting::is_training() const {
    if (learners_.empty()) return false;
    return learners_.back()->never_stops_learning() ||
           n_passes_ < passes_of_each_ * static_cast<std::int64_t>(learners_.size());
}

void Weighting::start_pass(bool trains) {
    observers_.clear();
    if (observer_ != nullptr) observers_.push_back(observer_);
    if (trains && is_training()) observers_.push_back(learner().trainer());
    wants_zeros_ = false;
    for (const SampleObserver* observer : observers_) {
        wants_zeros_ = wants_zeros_ || observer->wants_zeros();
    }
}

Forgotten Weighting::finish_pass(ThreadPool& threads) {
    if (!is_training()) return {};
    FactorProvider& of_pass = learner();
    ++n_passes_;
    return of_pass.finish_pass(threads, n_passes_ % passes_of_each_ == 0);
}

void Weighting::start_phase(std::size_t n_chunks) const {
    for (SampleObserver* observer : observers_) observer->start_phase(n_chunks);
}
void Weighting::finish_phase() const {
    for (SampleObserver* observer : observers_) observer->finish_phase();
}
void Weighting::show(const Sample& sample, std::size_t chunk) const {
    for (SampleObserver* observer : observers_) {
        // What one wants beside the others changes nothing of what they learn.
        if (sample.value == Rgb{} && !observer->wants_zeros()) continue;
        observer->observe(sample, chunk);
    }
}

void Weighting::describe(nlohmann::json& json) const {
    for (const auto& provider : providers_) provider->describe(json);
}

std::vector<NamedImage> Weighting::maps() const {
    std::vector<NamedImage> all;
    for (const auto& provider : providers_) {
        for (NamedImage& map : provider->maps()) all.push_back(std::move(map));
    }
    return all;
}

}  // namespace misbench
