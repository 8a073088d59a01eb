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

void PassContext::run_tiles(const std::function<void(const Tile&, TileResult&)>& work) {
    const int columns = (frame_.width + kTileSide - 1) / kTileSide;
    const int rows = (frame_.height + kTileSide - 1) / kTileSide;
    std::vector<TileResult> results(static_cast<std::size_t>(columns * rows));
    complete_ = threads_.for_each(results.size(), stop_, [&](std::size_t i) {
        const int x0 = static_cast<int>(i) % columns * kTileSide;
        const int y0 = static_cast<int>(i) / columns * kTileSide;
        work({x0, y0, std::min(x0 + kTileSide, frame_.width),
              std::min(y0 + kTileSide, frame_.height)},
             results[i]);
    });
    for (const TileResult& result : results) {
        film_.n_rays += result.n_rays;
        film_.n_nonfinite += result.n_nonfinite;
        film_.n_negative += result.n_negative;
        if (result.first_bad &&
            (!film_.first_bad || comes_before(*result.first_bad, *film_.first_bad))) {
            film_.first_bad = result.first_bad;
        }
    }
}

void PassContext::put(int x, int y, Rgb value, TileResult& result) {
    film_.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(frame_.width) +
                 static_cast<std::size_t>(x)] = value;
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
