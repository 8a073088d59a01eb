#include "renderer/paths/photon_map.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "renderer/base/check.h"
#include "renderer/methods/thread_pool.h"

namespace misbench {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr Vec3 kNowhere = {kNaN, kNaN, kNaN};
constexpr Vec3 kAboveAll = {kInfinity, kInfinity, kInfinity};

// Work is cut by these numbers alone, never by the number of threads.
constexpr std::size_t kPointsPerChunk = 1 << 15;
constexpr std::size_t kNodesPerChunk = 1 << 10;  // or leaves

constexpr int kBitsPerAxis = 21;
constexpr std::uint64_t kKeyOfNoPoint = ~std::uint64_t{0};  // above those of points
constexpr int kKeyBits = 64;
constexpr int kDigitBits = 8;
constexpr std::size_t kDigits = 1 << kDigitBits;

constexpr std::size_t divide_up(std::size_t n, std::size_t by) { return (n + by - 1) / by; }

// Calls work(chunk, begin, end) for all of [0, n).
template <class Work>
void in_chunks(std::size_t n, std::size_t per_chunk, ThreadPool& threads, const Work& work) {
    const auto run = [&](std::size_t chunk) {
        work(chunk, chunk * per_chunk, std::min(n, (chunk + 1) * per_chunk));
    };
    // By reference: a copy would be allocated.
    threads.for_each(
        divide_up(n, per_chunk), [] { return false; }, std::cref(run));
}

bool is_finite(Vec3 p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

// Puts two zeros before each of the 21 bits.
constexpr std::uint64_t spread(std::uint64_t bits) {
    bits = (bits | bits << 32) & 0x001f00000000ffff;
    bits = (bits | bits << 16) & 0x001f0000ff0000ff;
    bits = (bits | bits << 8) & 0x100f00f00f00f00f;
    bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
    bits = (bits | bits << 2) & 0x1249249249249249;
    return bits;
}

}  // namespace

void PhotonMap::build(std::span<const Vec3> positions, ThreadPool& threads) {
    MISBENCH_CHECK(positions.size() <= std::numeric_limits<std::uint32_t>::max());
    make_keys(positions, threads);
    sort_keys(threads);
    make_leaves(positions, threads);
    n_levels_ = 0;
    if (leaves_.empty()) return;
    make_nodes(std::span<const Leaf>(leaves_), levels_[0], threads);
    for (n_levels_ = 1; levels_[n_levels_ - 1].size() > 1; ++n_levels_) {
        make_nodes(std::span<const Node>(levels_[n_levels_ - 1]), levels_[n_levels_], threads);
    }
}

// Around the finite positions.
PhotonMap::Box PhotonMap::bounds(std::span<const Vec3> positions, ThreadPool& threads) {
    chunk_bounds_.resize(divide_up(positions.size(), kPointsPerChunk));
    in_chunks(positions.size(), kPointsPerChunk, threads,
              [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                  Box box = {kAboveAll, -kAboveAll};
                  for (const Vec3 p : positions.subspan(begin, end - begin)) {
                      if (is_finite(p)) box = {min(box.lower, p), max(box.upper, p)};
                  }
                  chunk_bounds_[chunk] = box;
              });
    Box all = {kAboveAll, -kAboveAll};
    for (const Box& box : chunk_bounds_) {
        all = {min(all.lower, box.lower), max(all.upper, box.upper)};
    }
    return all;
}

// Numbers the cells of a cube around all positions along the curve. In double: differences of
// floats overflow, their reciprocals too.
void PhotonMap::make_keys(std::span<const Vec3> positions, ThreadPool& threads) {
    const Box box = bounds(positions, threads);
    const auto extent = [&box](float Vec3::*axis) {
        return double{box.upper.*axis} - double{box.lower.*axis};
    };
    const double size = std::max({extent(&Vec3::x), extent(&Vec3::y), extent(&Vec3::z)});
    const double scale = size > 0 ? ((1 << kBitsPerAxis) - 1) / size : 0;
    const auto morton = [&](Vec3 p) {
        const auto cell = [&](float Vec3::*axis) {
            return spread(
                static_cast<std::uint64_t>(scale * (double{p.*axis} - double{box.lower.*axis})));
        };
        return cell(&Vec3::x) << 2 | cell(&Vec3::y) << 1 | cell(&Vec3::z);
    };
    keys_.resize(positions.size());
    in_chunks(positions.size(), kPointsPerChunk, threads,
              [&](std::size_t, std::size_t begin, std::size_t end) {
                  for (std::size_t i = begin; i < end; ++i) {
                      const Vec3 p = positions[i];
                      keys_[i] = {is_finite(p) ? morton(p) : kKeyOfNoPoint,
                                  static_cast<std::uint32_t>(i)};
                  }
              });
}

// A radix sort from the lowest digit up. It is stable: equal keys stay in the order of their
// indices, so there is one result, however the work was cut.
void PhotonMap::sort_keys(ThreadPool& threads) {
    const std::size_t n = keys_.size();
    other_keys_.resize(n);
    histograms_.resize(divide_up(n, kPointsPerChunk) * kDigits);
    for (int shift = 0; shift < kKeyBits; shift += kDigitBits) {
        const auto digit = [shift](const Key& key) { return (key.morton >> shift) % kDigits; };
        const auto of_chunk = [this](std::size_t chunk) {
            return std::span(histograms_).subspan(chunk * kDigits, kDigits);
        };
        in_chunks(n, kPointsPerChunk, threads,
                  [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                      const auto count = of_chunk(chunk);
                      std::fill(count.begin(), count.end(), 0);
                      for (std::size_t i = begin; i < end; ++i) ++count[digit(keys_[i])];
                  });
        // From each chunk's number of keys with a digit to the place of the first of them.
        std::uint32_t place = 0;
        for (std::size_t d = 0; d < kDigits; ++d) {
            for (std::size_t i = d; i < histograms_.size(); i += kDigits) {
                place += std::exchange(histograms_[i], place);
            }
        }
        in_chunks(n, kPointsPerChunk, threads,
                  [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                      const auto next = of_chunk(chunk);
                      for (std::size_t i = begin; i < end; ++i) {
                          other_keys_[next[digit(keys_[i])]++] = keys_[i];
                      }
                  });
        keys_.swap(other_keys_);
    }
}

void PhotonMap::make_leaves(std::span<const Vec3> positions, ThreadPool& threads) {
    const auto end_of_points = std::partition_point(
        keys_.begin(), keys_.end(), [](const Key& key) { return key.morton != kKeyOfNoPoint; });
    const auto n_points = static_cast<std::size_t>(end_of_points - keys_.begin());
    leaves_.resize(divide_up(n_points, kWidth));
    in_chunks(leaves_.size(), kNodesPerChunk, threads,
              [&](std::size_t, std::size_t begin, std::size_t end) {
                  for (std::size_t i = begin * kWidth; i < end * kWidth; ++i) {
                      Leaf& leaf = leaves_[i / kWidth];
                      const std::uint32_t index = i < n_points ? keys_[i].index : 0;
                      leaf.position.set(i % kWidth, i < n_points ? positions[index] : kNowhere);
                      leaf.index[i % kWidth] = index;
                  }
              });
}

// min() and max() keep their first argument where the second is not a number.
PhotonMap::Box PhotonMap::around(const Leaf& leaf) {
    Box box = {leaf.position.at(0), leaf.position.at(0)};
    for (std::size_t i = 1; i < kWidth; ++i) {
        const Vec3 p = leaf.position.at(i);
        box = {min(box.lower, p), max(box.upper, p)};
    }
    return box;
}

PhotonMap::Box PhotonMap::around(const Node& node) {
    Box box = {node.lower.at(0), node.upper.at(0)};
    for (std::size_t i = 1; i < kWidth; ++i) {
        box = {min(box.lower, node.lower.at(i)), max(box.upper, node.upper.at(i))};
    }
    return box;
}

template <class Child>
void PhotonMap::make_nodes(std::span<const Child> children, std::vector<Node>& nodes,
                           ThreadPool& threads) {
    nodes.resize(divide_up(children.size(), kWidth));
    in_chunks(nodes.size(), kNodesPerChunk, threads,
              [&](std::size_t, std::size_t begin, std::size_t end) {
                  for (std::size_t i = begin * kWidth; i < end * kWidth; ++i) {
                      const Box box =
                          i < children.size() ? around(children[i]) : Box{kAboveAll, -kAboveAll};
                      nodes[i / kWidth].lower.set(i % kWidth, box.lower);
                      nodes[i / kWidth].upper.set(i % kWidth, box.upper);
                  }
              });
}

}  // namespace misbench
