#include "renderer/paths/technique_images.h"

#include "renderer/base/check.h"

namespace misbench {
namespace {

// Orders techniques by path length, then by index: paths of up to n edges have the keys below
// n (n + 1).
int key_of(int n_edges, Technique technique) {
    return n_edges * (n_edges - 1) + technique.index(n_edges);
}

Image mean(const std::vector<double>& sums, std::int64_t n_passes, int width, int height) {
    Image image(width, height);
    for (std::size_t i = 0; i < sums.size(); ++i) {
        image.rgb[i] = static_cast<float>(sums[i] / static_cast<double>(n_passes));
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

void TechniqueImages::start_phase(std::size_t n_chunks) {
    chunks_.clear();
    chunks_.resize(n_chunks);
}

void TechniqueImages::observe(const Sample& sample, std::size_t chunk) {
    const Pixel pixel = sample.path.pixel;
    Chunk& own = chunks_[chunk];
    const Addition addition{
        .sums = &sums_of(key_of(sample.path.n_edges(), sample.technique), own),
        .at = 3 * (static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(width_) +
                   static_cast<std::size_t>(pixel.x)),
        .value = sample.value,
        .weight = sample.weight};
    // Light paths reach a pixel from any chunk; of all other samples it is this chunk's alone.
    if (sample.technique.kind == TechniqueKind::Light) {
        own.of_light_paths.push_back(addition);
    } else {
        add(addition);
    }
}

void TechniqueImages::finish_phase() {
    for (const Chunk& chunk : chunks_) {
        for (const Addition& addition : chunk.of_light_paths) add(addition);
    }
    chunks_.clear();
}

TechniqueImages::Sums& TechniqueImages::sums_of(int key, Chunk& chunk) {
    Sums*& known = chunk.known[key];
    if (known != nullptr) return *known;
    const std::lock_guard lock(mutex_);
    std::unique_ptr<Sums>& sums = sums_[key];
    if (sums == nullptr) {
        const std::size_t n = Image(width_, height_).rgb.size();
        sums = std::make_unique<Sums>(
            Sums{.weighted = std::vector<double>(n), .unweighted = std::vector<double>(n)});
    }
    known = sums.get();
    return *known;
}

void TechniqueImages::add(const Addition& addition) {
    const Rgb value = addition.value;
    double* weighted = &addition.sums->weighted[addition.at];
    double* unweighted = &addition.sums->unweighted[addition.at];
    for (const float channel : {value.r, value.g, value.b}) {
        *weighted++ += addition.weight * double{channel};
        *unweighted++ += double{channel};
    }
}

std::vector<TechniqueImage> TechniqueImages::means(std::int64_t n_passes) const {
    MISBENCH_CHECK(n_passes > 0);
    std::vector<TechniqueImage> images;
    int n_edges = 1;
    for (const auto& [key, sums] : sums_) {
        while (key >= n_edges * (n_edges + 1)) ++n_edges;
        images.push_back({.n_edges = n_edges,
                          .technique = technique_at(key - n_edges * (n_edges - 1), n_edges),
                          .weighted = mean(sums->weighted, n_passes, width_, height_),
                          .unweighted = mean(sums->unweighted, n_passes, width_, height_)});
    }
    return images;
}

}  // namespace misbench
