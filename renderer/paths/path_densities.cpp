#include "renderer/paths/path_densities.h"

#include <algorithm>
#include <limits>

namespace misbench {

Technique technique_at(int index, int n_edges) {
    if (index < 3) return {static_cast<TechniqueKind>(index), 0};
    if (index <= n_edges) return {TechniqueKind::Connect, index - 2};
    return {TechniqueKind::Merge, index - n_edges};
}

namespace {

// The products in units of the largest.
template <class Real>
void normalise(const std::vector<ScaledProduct<Real>>& products, std::span<double> q) {
    // Mostly none of them needed an exponent.
    bool plain = true;
    for (std::size_t i = 0; i < q.size(); ++i) {
        plain = plain && products[i].exponent() == 0;
        q[i] = static_cast<double>(products[i].significand());
    }
    if (!plain) {
        std::int64_t top = std::numeric_limits<std::int64_t>::min();
        const auto exponent_of = [&](std::size_t i) {
            return products[i].exponent() + std::ilogb(q[i]);
        };
        for (std::size_t i = 0; i < q.size(); ++i) {
            if (q[i] != 0) top = std::max(top, exponent_of(i));
        }
        for (std::size_t i = 0; i < q.size(); ++i) {
            if (q[i] == 0) continue;
            constexpr std::int64_t kLost = -3000;  // 0 in any type
            const std::int64_t shift = std::max(exponent_of(i) - top, kLost);
            q[i] = std::ldexp(q[i], static_cast<int>(shift) - std::ilogb(q[i]));
        }
    }
    const double largest = *std::max_element(q.begin(), q.end());
    if (largest == 0) return;
    for (double& q_t : q) q_t *= 1 / largest;
}

}  // namespace

template <class Real>
std::span<double> effective_densities(const PathDensities& path, const TechniqueCounts& counts,
                                      DensityScratch<Real>& scratch) {
    using Product = ScaledProduct<Real>;
    const auto n = static_cast<std::size_t>(path.n_edges);
    const auto n_all = static_cast<std::size_t>(n_techniques(path.n_edges));
    if (scratch.q.size() < n_all) {
        scratch.q.resize(n_all);
        scratch.products.resize(n_all);
        scratch.to_light.resize(n + 2);
    }
    const std::span q(scratch.q.data(), n_all);
    if (n == 1) {
        q[0] = 1;
        return q;
    }
    const auto real = [](double x) { return static_cast<Real>(x); };
    const bool has_light_paths = counts.light > 0 || counts.connect > 0 || counts.merge > 0;
    std::vector<Product>& to_light = scratch.to_light;
    std::vector<Product>& products = scratch.products;
    std::fill(products.begin(), products.begin() + static_cast<std::ptrdiff_t>(n_all),
              Product(Real(0)));
    if (has_light_paths) {
        to_light[n + 1] = Product();
        for (std::size_t i = n; i >= 1; --i) {
            to_light[i] = to_light[i + 1];
            to_light[i] *= real(path.from_light[i]);
        }
        if (!path.is_delta[1]) products[2] = to_light[1] * Product(real(counts.light));
    }
    // C_1 … C_k, and the number of camera paths that share them.
    Product from_camera;
    for (std::size_t k = 1; k < n; ++k) {
        from_camera *= real(path.from_camera[k]);
        if (k == 2 && counts.split != 1) from_camera *= real(counts.split);
        if (path.is_delta[k]) continue;
        if (has_light_paths) {
            const Product joined = from_camera * to_light[k + 1];
            if (k + 2 <= n && !path.is_delta[k + 1] && counts.connect > 0) {
                products[2 + k] = joined * Product(real(counts.connect));
            }
            if ((k > 1 || counts.merge_first) && counts.merge > 0) {
                products[n + k] = joined * Product(real(path.from_light[k]));
                products[n + k] *= real(path.merge_area * counts.merge);
            }
        }
    }
    if (!path.is_delta[n - 1]) {
        products[1] = from_camera * Product(real(path.next_event * counts.nee));
    }
    from_camera *= real(path.from_camera[n]);
    if (n == 2 && counts.split != 1) from_camera *= real(counts.split);
    products[0] = from_camera * Product(real(counts.hit));
    normalise(products, q);
    return q;
}

template std::span<double> effective_densities<double>(const PathDensities&, const TechniqueCounts&,
                                                       DensityScratch<double>&);
template std::span<double> effective_densities<float>(const PathDensities&, const TechniqueCounts&,
                                                      DensityScratch<float>&);

}  // namespace misbench
