#include "experiments/figure/auto_crops.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "renderer/base/check.h"

namespace misbench::figure {
namespace {

constexpr int kReach = 2;  // of the median, in pixels to each side

double median_around(const ValueMap& map, int x, int y) {
    std::array<double, (2 * kReach + 1) * (2 * kReach + 1)> values{};
    std::size_t n = 0;
    for (int v = std::max(0, y - kReach); v <= std::min(map.height - 1, y + kReach); ++v) {
        for (int u = std::max(0, x - kReach); u <= std::min(map.width - 1, x + kReach); ++u) {
            if (std::isfinite(map.at(u, v))) values[n++] = map.at(u, v);
        }
    }
    if (n == 0) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(n / 2);
    std::nth_element(values.begin(), middle, values.begin() + static_cast<std::ptrdiff_t>(n));
    return *middle;
}

// Sums of |a - b| over all rectangles from the upper left corner, with a row and a column of zeros.
class SummedDifferences {
 public:
    SummedDifferences(const ValueMap& a, const ValueMap& b)
        : stride_(a.width + 1), sums_(index(0, a.height + 1), 0.0) {
        for (int y = 0; y < a.height; ++y) {
            for (int x = 0; x < a.width; ++x) {
                sums_[index(x + 1, y + 1)] =
                    std::abs(median_around(a, x, y) - median_around(b, x, y)) +
                    sums_[index(x, y + 1)] + sums_[index(x + 1, y)] - sums_[index(x, y)];
            }
        }
    }
    double within(const Window& w) const {
        return sums_[index(w.x + w.width, w.y + w.height)] - sums_[index(w.x, w.y + w.height)] -
               sums_[index(w.x + w.width, w.y)] + sums_[index(w.x, w.y)];
    }

 private:
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(stride_) +
               static_cast<std::size_t>(x);
    }
    int stride_;
    std::vector<double> sums_;
};

bool are_apart(const Window& a, const Window& b) {
    return 2 * std::abs(a.x - b.x) >= 3 * a.width || 2 * std::abs(a.y - b.y) >= 3 * a.height;
}

}  // namespace

std::vector<Window> auto_crops(const ValueMap& a, const ValueMap& b, int width, int height,
                               int count) {
    MISBENCH_CHECK(a.width == b.width && a.height == b.height);
    MISBENCH_CHECK(0 < width && width <= a.width && 0 < height && height <= a.height);
    const SummedDifferences sums(a, b);
    std::vector<Window> crops;
    while (static_cast<int>(crops.size()) < count) {
        std::optional<Window> best;
        double largest = -1;
        for (int y = 0; y + height <= a.height; ++y) {
            for (int x = 0; x + width <= a.width; ++x) {
                const Window window{x, y, width, height};
                const double difference = sums.within(window);
                const auto apart = [&](const Window& other) { return are_apart(window, other); };
                if (difference > largest && std::ranges::all_of(crops, apart)) {
                    largest = difference;
                    best = window;
                }
            }
        }
        if (!best) break;
        crops.push_back(*best);
    }
    return crops;
}

}  // namespace misbench::figure
