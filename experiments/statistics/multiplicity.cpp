#include "experiments/statistics/multiplicity.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

#include "renderer/base/check.h"

namespace misbench {
namespace {

// Indices of the p values, smallest first.
std::vector<std::size_t> ascending(std::span<const double> p) {
    for (const double value : p) MISBENCH_CHECK(value >= 0 && value <= 1);
    std::vector<std::size_t> order(p.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, [p](std::size_t a, std::size_t b) { return p[a] < p[b]; });
    return order;
}

}  // namespace

std::vector<double> benjamini_hochberg(std::span<const double> p) {
    const std::vector<std::size_t> order = ascending(p);
    const auto n = static_cast<double>(p.size());
    std::vector<double> adjusted(p.size());
    double smallest_above = 1;
    for (std::size_t k = order.size(); k > 0; --k) {
        const std::size_t i = order[k - 1];
        smallest_above = std::min(smallest_above, p[i] * n / static_cast<double>(k));
        adjusted[i] = smallest_above;
    }
    return adjusted;
}

std::vector<double> holm(std::span<const double> p) {
    const std::vector<std::size_t> order = ascending(p);
    std::vector<double> adjusted(p.size());
    double largest_below = 0;
    for (std::size_t k = 0; k < order.size(); ++k) {
        const std::size_t i = order[k];
        largest_below = std::max(largest_below, p[i] * static_cast<double>(order.size() - k));
        adjusted[i] = std::min(largest_below, 1.0);
    }
    return adjusted;
}

}  // namespace misbench
