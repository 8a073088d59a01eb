#include "renderer/weights/filters.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "renderer/methods/thread_pool.h"

namespace misbench {
namespace {

// Lines of a plane that are filtered side by side.
constexpr std::size_t kBlock = 16;
using Block = std::array<float, kBlock>;

void for_each(std::size_t n, ThreadPool& threads, const std::function<void(std::size_t)>& work) {
    threads.for_each(
        n, [] { return false; }, work);
}

// to[i] = the mean of from[i - radius … i + radius], of those that are there.
void box_filter(const std::vector<Block>& from, std::vector<Block>& to, int radius) {
    const auto n = static_cast<int>(from.size());
    for (int i = 0; i < n; ++i) {
        const int begin = std::max(i - radius, 0);
        const int end = std::min(i + radius + 1, n);
        Block sum{};
        for (int j = begin; j < end; ++j) {
            const Block& addend = from[static_cast<std::size_t>(j)];
            for (std::size_t b = 0; b < kBlock; ++b) sum[b] += addend[b];
        }
        const float scale = 1 / static_cast<float>(end - begin);
        for (float& value : sum) value *= scale;
        to[static_cast<std::size_t>(i)] = sum;
    }
}

// Filters n_lines lines of n values each; the values of a line lie `step` apart, lines `line_step`.
void filter_lines(std::vector<float>& values, std::size_t n_lines, std::size_t n, std::size_t step,
                  std::size_t line_step, int radius, int passes, ThreadPool& threads) {
    for_each((n_lines + kBlock - 1) / kBlock, threads, [&](std::size_t block) {
        const std::size_t first = block * kBlock;
        const std::size_t n_here = std::min(kBlock, n_lines - first);
        std::vector<Block> lines(n);
        std::vector<Block> filtered(n);
        const auto value = [&](std::size_t i, std::size_t line) -> float& {
            return values[(first + line) * line_step + i * step];
        };
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t b = 0; b < n_here; ++b) lines[i][b] = value(i, b);
        }
        for (int pass = 0; pass < passes; ++pass) {
            box_filter(lines, filtered, radius);
            lines.swap(filtered);
        }
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t b = 0; b < n_here; ++b) value(i, b) = lines[i][b];
        }
    });
}

// Of features at a pixel of a neighbour: both that see nothing are alike, one alone is not.
float likeness(const PixelFeature& a, const PixelFeature& b) {
    constexpr float kNormalSpread = 0.1F;
    constexpr float kDistanceSpread = 0.05F;
    if (a.distance == 0 || b.distance == 0) return a.distance == b.distance ? 1 : 0;
    const float turned = (1 - dot(a.normal, b.normal)) / kNormalSpread;
    const float moved = (a.distance - b.distance) / (kDistanceSpread * a.distance);
    return std::exp(-turned * turned - moved * moved);
}

}  // namespace

void box_filter(Plane& plane, int radius, int passes, ThreadPool& threads) {
    const auto width = static_cast<std::size_t>(plane.width);
    const auto height = static_cast<std::size_t>(plane.height);
    // The mean over a square is the mean over its columns of the means over its rows.
    filter_lines(plane.values, height, width, 1, width, radius, passes, threads);
    filter_lines(plane.values, width, height, width, 1, radius, passes, threads);
}

void bilateral_filter(Plane& plane, int passes, std::span<const PixelFeature> features,
                      ThreadPool& threads) {
    if (passes == 0) return;
    const double sigma = std::sqrt(2.0 * passes / 3);
    const int reach = static_cast<int>(std::ceil(3 * sigma));
    std::vector<float> gaussian;
    for (int i = 0; i <= reach; ++i) {
        gaussian.push_back(static_cast<float>(std::exp(-i * i / (2 * sigma * sigma))));
    }
    const std::vector<float> from = plane.values;
    for_each(static_cast<std::size_t>(plane.height), threads, [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < plane.width; ++x) {
            const auto at = [&](int u, int v) {
                return static_cast<std::size_t>(v) * static_cast<std::size_t>(plane.width) +
                       static_cast<std::size_t>(u);
            };
            float sum = 0;
            float sum_of_weights = 0;
            for (int v = std::max(y - reach, 0); v <= std::min(y + reach, plane.height - 1); ++v) {
                for (int u = std::max(x - reach, 0); u <= std::min(x + reach, plane.width - 1);
                     ++u) {
                    const float weight = gaussian[static_cast<std::size_t>(std::abs(u - x))] *
                                         gaussian[static_cast<std::size_t>(std::abs(v - y))] *
                                         likeness(features[at(x, y)], features[at(u, v)]);
                    if (weight == 0) continue;  // also beside what is infinite
                    sum += weight * from[at(u, v)];
                    sum_of_weights += weight;
                }
            }
            plane.values[at(x, y)] = sum / sum_of_weights;
        }
    });
}

}  // namespace misbench
