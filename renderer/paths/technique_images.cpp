#include "renderer/paths/technique_images.h"

#include <array>

#include "renderer/base/check.h"

namespace misbench {
namespace {

// Three channels of a pixel's six, from the first on.
Image mean(const std::vector<double>& sums, std::size_t first, std::int64_t n_passes, int width,
           int height) {
    Image image(width, height);
    for (std::size_t i = 0; i < image.rgb.size(); ++i) {
        image.rgb[i] =
            static_cast<float>(sums[i / 3 * 6 + first + i % 3] / static_cast<double>(n_passes));
    }
    return image;
}

}  // namespace

std::string technique_name(Technique technique) {
    switch (technique.kind) {
        case TechniqueKind::Hit:
            return "hit";
        case TechniqueKind::NextEvent:
            return "nee";
        case TechniqueKind::Light:
            return "light";
        case TechniqueKind::Connect:
            return "connect" + std::to_string(technique.k);
        case TechniqueKind::Merge:
            break;
    }
    return "merge" + std::to_string(technique.k);
}

std::string TechniqueImage::name() const {
    return "n" + std::to_string(n_edges) + "." + technique_name(technique);
}

void TechniqueImages::observe(const Sample& sample, std::size_t chunk) {
    const std::array value = {double{sample.value.r}, double{sample.value.g},
                              double{sample.value.b}};
    std::array<double, kChannels> both;
    for (std::size_t c = 0; c < 3; ++c) {
        both[c] = sample.weight * value[c];
        both[3 + c] = value[c];
    }
    sums_.add(sample, chunk, technique_key(sample.path.n_edges(), sample.technique),
              sample.path.pixel.index(width_), both);
}

std::vector<TechniqueImage> TechniqueImages::means(std::int64_t n_passes) const {
    MISBENCH_CHECK(n_passes > 0);
    std::vector<TechniqueImage> images;
    int n_edges = 1;
    for (const auto& [key, sums] : sums_.images()) {
        while (key >= first_technique_key(n_edges + 1)) ++n_edges;
        images.push_back({.n_edges = n_edges,
                          .technique = technique_at(key - first_technique_key(n_edges), n_edges),
                          .weighted = mean(sums, 0, n_passes, width_, height_),
                          .unweighted = mean(sums, 3, n_passes, width_, height_)});
    }
    return images;
}

}  // namespace misbench
