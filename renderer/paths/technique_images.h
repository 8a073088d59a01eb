// What every technique of every path length contributes to the image, with and without its weights:
// the pyramid of [Vea97 ch. 10].
//
// [Vea97]  E. Veach, Robust Monte Carlo Methods for Light Transport Simulation, 1997.
#pragma once

#include <string>
#include <vector>

#include "renderer/image/image.h"
#include "renderer/paths/pixel_sums.h"

namespace misbench {

// "hit", "nee", "light", "connect2", "merge1".
std::string technique_name(Technique technique);

struct TechniqueImage {
    int n_edges = 0;
    Technique technique{};
    Image weighted{};    // these sum to the image
    Image unweighted{};  // each expects all light of its paths, where it alone can make them

    // "n4.connect2".
    std::string name() const;
};

// Sums all samples that it sees, of all passes; the same bits for every number of threads. There is
// an image only for what had a sample.
class TechniqueImages final : public SampleObserver {
 public:
    TechniqueImages(int width, int height)
        : width_(width), height_(height), sums_(Image(width, height).n_pixels(), kChannels) {}

    void start_phase(std::size_t n_chunks) override { sums_.start_phase(n_chunks); }
    void observe(const Sample& sample, std::size_t chunk) override;
    void finish_phase() override { sums_.finish_phase(); }

    // The means over so many passes, by path length, then by index of technique.
    std::vector<TechniqueImage> means(std::int64_t n_passes) const;

 private:
    static constexpr std::size_t kChannels = 6;  // weighted and unweighted, red, green and blue

    int width_;
    int height_;
    PixelSums<double> sums_;  // by technique_key()
};

}  // namespace misbench
