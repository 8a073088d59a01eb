#include "renderer/weights/jendersie.h"

#include <array>
#include <cmath>
#include <vector>

namespace misbench {
namespace {

constexpr double kExponent = 4.5;
constexpr double kOffset = 0.01;  // of the root of a density, so that it has a unit of length

class Jendersie final : public FactorProvider {
 public:
    // c of merging at x_k = (f_c^e + f_l^e) / (n f_c^e + f_l^e), f the footprints there of both
    // subpaths: sums of 1 / (0.01 + √p) over their vertices.                             [Jen19]
    void multiply(const PathView& path, const TechniqueCounts& counts,
                  std::span<double> factors) const override {
        const auto n = static_cast<std::size_t>(path.n_edges());
        if (n < 2 || counts.merge <= 1) return;
        const PathDensities& d = *path.densities;
        const bool is_delta_light = !path.light.empty() && path.light.front().is_delta_light;
        const auto footprint = [](double density) { return 1 / (kOffset + std::sqrt(density)); };
        // Behind a delta lobe, of infinite density, there is none.
        const auto from = [&](std::size_t neighbour, double density) {
            return d.is_delta[neighbour] != 0 ? 0 : footprint(density);
        };

        std::array<double, kFewEdges> few;
        std::vector<double> many;
        double* light = few.data();  // f_l by k
        if (n > kFewEdges) light = (many.resize(n), many.data());
        light[n - 1] =
            footprint(d.from_light[n - 1]) + (is_delta_light ? 0 : footprint(d.from_light[n]));
        for (std::size_t k = n - 2; k >= 1; --k) {
            light[k] = light[k + 1] + from(k + 1, d.from_light[k]);
        }
        double camera = 0;  // f_c
        for (std::size_t k = 1; k < n; ++k) {
            camera += k == 1 ? footprint(d.from_camera[1]) : from(k - 1, d.from_camera[k]);
            // (f_l / f_c)^e: neither power is made alone.
            const double ratio = std::pow(light[k] / camera, kExponent);
            if (std::isfinite(ratio)) factors[n + k] *= (1 + ratio) / (counts.merge + ratio);
        }
    }

 private:
    static constexpr std::size_t kFewEdges = 24;
};

}  // namespace

std::shared_ptr<FactorProvider> make_jendersie() { return std::make_shared<Jendersie>(); }

}  // namespace misbench
