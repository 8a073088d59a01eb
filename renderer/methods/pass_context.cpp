#include "renderer/methods/pass_context.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace misbench {
namespace {

// Side of a tile in pixels: enough work to hide the hand-out of a chunk, little enough that a time
// budget is noticed soon.
constexpr int kTileSide = 16;

bool comes_before(const SamplePlace& a, const SamplePlace& b) {
    return std::tie(a.pass, a.y, a.x) < std::tie(b.pass, b.y, b.x);
}

}  // namespace

void PassFilm::clear(std::size_t n_pixels) {
    pixels.assign(n_pixels, Rgb{});
    for (std::vector<Splat>& chunk : splats) chunk.clear();
    n_rays = n_nonfinite = n_negative = 0;
    first_bad.reset();
}

std::size_t PassContext::n_tiles() const {
    return static_cast<std::size_t>((frame_.width + kTileSide - 1) / kTileSide) *
           static_cast<std::size_t>((frame_.height + kTileSide - 1) / kTileSide);
}

PassContext::Tile PassContext::tile_at(std::size_t chunk) const {
    const int columns = (frame_.width + kTileSide - 1) / kTileSide;
    const int x0 = static_cast<int>(chunk) % columns * kTileSide;
    const int y0 = static_cast<int>(chunk) / columns * kTileSide;
    return {x0, y0, std::min(x0 + kTileSide, frame_.width),
            std::min(y0 + kTileSide, frame_.height)};
}

void PassContext::run_chunks(std::size_t n,
                             const std::function<void(std::size_t, ChunkResult&)>& work) {
    if (!complete_) return;
    std::vector<ChunkResult> results(n);
    complete_ = threads_.for_each(n, stop_, [&](std::size_t i) { work(i, results[i]); });
    for (const ChunkResult& result : results) {
        film_.n_rays += result.n_rays;
        film_.n_nonfinite += result.n_nonfinite;
        film_.n_negative += result.n_negative;
        if (result.first_bad &&
            (!film_.first_bad || comes_before(*result.first_bad, *film_.first_bad))) {
            film_.first_bad = result.first_bad;
        }
    }
}

void PassContext::add_splats() {
    film_.splat_sums.assign(3 * film_.pixels.size(), 0.0);
    for (const std::vector<Splat>& chunk : film_.splats) {
        for (const Splat& splat : chunk) {
            double* sum = &film_.splat_sums[3 * std::size_t{splat.pixel}];
            sum[0] += double{splat.value.r};
            sum[1] += double{splat.value.g};
            sum[2] += double{splat.value.b};
        }
    }
    for (std::size_t i = 0; i < film_.pixels.size(); ++i) {
        const double* sum = &film_.splat_sums[3 * i];
        film_.pixels[i] +=
            {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])};
    }
}

void PassContext::check(int x, int y, Rgb value, ChunkResult& result) const {
    const bool finite = std::isfinite(value.r) && std::isfinite(value.g) && std::isfinite(value.b);
    const bool negative = value.r < 0 || value.g < 0 || value.b < 0;
    if (finite && !negative) [[likely]] {
        return;
    }
    if (!finite) ++result.n_nonfinite;
    if (negative) ++result.n_negative;
    const SamplePlace place{.x = x, .y = y, .pass = pass_};
    if (!result.first_bad || comes_before(place, *result.first_bad)) result.first_bad = place;
}

}  // namespace misbench
