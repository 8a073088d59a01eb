// What every technique of every path length contributes to the image, with and without its weights:
// the pyramid of [Vea97 ch. 10].
//
// [Vea97]  E. Veach, Robust Monte Carlo Methods for Light Transport Simulation, 1997.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "renderer/image/image.h"
#include "renderer/paths/sample.h"

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
    TechniqueImages(int width, int height) : width_(width), height_(height) {}

    void start_phase(std::size_t n_chunks) override;
    void observe(const Sample& sample, std::size_t chunk) override;
    void finish_phase() override;

    // The means over so many passes, by path length, then by index of technique.
    std::vector<TechniqueImage> means(std::int64_t n_passes) const;

 private:
    struct Sums {
        std::vector<double> weighted;  // as Image::rgb
        std::vector<double> unweighted;
    };
    struct Addition {
        Sums* sums = nullptr;
        std::size_t at = 0;  // of the pixel's red
        Rgb value{};
        double weight = 0;
    };
    struct Chunk {
        std::unordered_map<int, Sums*> known;  // by key, so that each is locked for but once
        std::vector<Addition> of_light_paths;
    };

    Sums& sums_of(int key, Chunk& chunk);
    static void add(const Addition& addition);

    int width_;
    int height_;
    std::mutex mutex_;                           // of sums_, not of what it points to
    std::map<int, std::unique_ptr<Sums>> sums_;  // by key
    std::vector<Chunk> chunks_;                  // of the phase
};

}  // namespace misbench
