// Keeps all samples of one pixel, with their paths.
#pragma once

#include <optional>
#include <vector>

#include "renderer/paths/sample.h"

namespace misbench {

// A Sample that outlives its event.
struct KeptSample {
    PathDensities densities{};
    std::vector<PathVertex> vertices{};  // x_1 … x_n
    // The end of the light's subpath that was merged with x_k.
    std::optional<PathVertex> photon{};
    Technique technique{};
    Rgb value{};
    double weight = 0;
    std::vector<double> q{};
    std::vector<double> factors{};
};

class PixelTrace final : public SampleObserver {
 public:
    explicit PixelTrace(Pixel pixel) : pixel_(pixel) {}

    void start_phase(std::size_t n_chunks) override { chunks_.resize(n_chunks); }
    void observe(const Sample& sample, std::size_t chunk) override;
    void finish_phase() override;

    // By phase, then by chunk: the same for every number of threads.
    const std::vector<KeptSample>& samples() const { return samples_; }

 private:
    Pixel pixel_;
    std::vector<std::vector<KeptSample>> chunks_;
    std::vector<KeptSample> samples_;
};

}  // namespace misbench
