#include "renderer/paths/pixel_trace.h"

#include <algorithm>
#include <iterator>

namespace misbench {
namespace {

// Without the elements beyond the path's end.
PathDensities shortened(PathDensities densities) {
    const auto size = static_cast<std::size_t>(densities.n_edges) + 1;
    densities.from_camera.resize(size);
    densities.from_light.resize(size);
    densities.is_delta.resize(size);
    return densities;
}

}  // namespace

void PixelTrace::observe(const Sample& sample, std::size_t chunk) {
    const PathView& path = sample.path;
    if (path.pixel != pixel_) return;
    KeptSample kept{.densities = shortened(*path.densities),
                    .technique = sample.technique,
                    .value = sample.value,
                    .weight = sample.weight,
                    .q = {sample.q.begin(), sample.q.end()},
                    .factors = {sample.factors.begin(), sample.factors.end()}};
    for (int i = 1; i <= path.n_edges(); ++i) kept.vertices.push_back(path.vertex(i));
    if (sample.technique.kind == TechniqueKind::Merge) kept.photon = path.light.back();
    chunks_[chunk].push_back(std::move(kept));
}

void PixelTrace::finish_phase() {
    for (std::vector<KeptSample>& chunk : chunks_)
        std::ranges::move(chunk, std::back_inserter(samples_));
    chunks_.clear();
}

}  // namespace misbench
