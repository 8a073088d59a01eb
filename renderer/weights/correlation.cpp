// The samples of some techniques share a prefix y = x_1 … x_k and differ in the rest z of the path:
// photons merged at x_k (z ends there too), shadow rays from x_{n-1} (z is x_n alone).
//
// P(y), P(z)   probability that each vertex is sampled again within the radius of where it is
#include "renderer/weights/correlation.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "renderer/base/error.h"
#include "renderer/mis/factors.h"
#include "renderer/paths/scaled_product.h"

namespace misbench {
namespace {

constexpr double kMaxScale = 1e6;

class Correlation final : public FactorProvider {
 public:
    explicit Correlation(const CorrelationParameters& parameters)
        : is_global_(parameters.radius == "global"),
          scale_(parameters.scale),
          is_bounded_(parameters.bounded) {}

    void start(const Scene& scene, FrameInfo /*frame*/) override {
        scene_radius_ = double{scene.radius()};
    }

    void multiply(const PathView& path, const TechniqueCounts& counts,
                  std::span<double> factors) const override {
        const auto n = static_cast<std::size_t>(path.n_edges());
        if (n < 2 || (counts.merge <= 1 && counts.nee <= 1)) return;
        // Plain numbers are enough for all but extreme scenes, and take half the time.
        double few[2 * kFewEdges];  // NOLINT: not filled, for speed
        if (n <= kFewEdges && multiply_all(path, counts, factors, few, few + kFewEdges)) return;
        std::vector<Scaled> many(2 * n);
        multiply_all(path, counts, factors, many.data(), many.data() + n);
    }

 private:
    using Scaled = ScaledProduct<double>;
    static constexpr std::size_t kFewEdges = 24;

    // c_t of all techniques, with probabilities as Products. `prefix` and `rest` have room for one
    // a vertex. False where a double would lose digits: then the factors are as they were.
    template <typename Product>
    bool multiply_all(const PathView& path, const TechniqueCounts& counts,
                      std::span<double> factors, Product* prefix, Product* rest) const {
        const bool merges = counts.merge > 1;
        const auto n = static_cast<std::size_t>(path.n_edges());
        const PathDensities& d = *path.densities;
        const double d2 = squared_length(path.vertex(1).point.position - path.origin);
        const double area = area_around(d2);
        // Of x_n: an infinitely far one is a direction, as far from the next as the camera sees the
        // radius; a delta light's is a probability.
        const bool is_infinite = !path.light.empty() && path.light.front().is_infinite;
        const bool is_delta = !path.light.empty() && path.light.front().is_delta_light;
        const double at_light = is_delta ? 1 : is_infinite ? area / d2 : area;
        const auto chance = [](double density, double measure) {
            return std::min(1.0, density * measure);  // [grittmann2021 Eq. 16]
        };
        // Of a vertex whose neighbour scatters there: by a delta lobe, of infinite density,
        // certainly.
        const auto again = [&](double density, std::size_t neighbour) {
            const bool is_certain = d.is_delta[neighbour] != 0 && density > 0;
            return is_certain ? 1 : chance(density, area);
        };

        // P(y) of x_1 … x_k, for all k.                               [grittmann2021 Eq. 14]
        Product product(1);
        for (std::size_t k = 1; k < n; ++k) {
            const double last =
                k == 1 ? chance(d.from_camera[k], area) : again(d.from_camera[k], k - 1);
            if (!extend(product, last)) return false;
            prefix[k] = product;
        }
        // P(z) that ends at x_k, for all k.
        if (merges) {
            product = Product(1);
            if (!extend(product, chance(d.from_light[n], at_light))) return false;
            for (std::size_t k = n - 1; k >= 1; --k) {
                const double last =
                    k == n - 1 ? chance(d.from_light[k], area) : again(d.from_light[k], k + 1);
                if (!extend(product, last)) return false;
                rest[k] = product;
            }
            const double bound = least(counts.merge);
            for (std::size_t k = 1; k < n; ++k) {
                factors[n + k] *= std::max(factor(prefix[k], rest[k]), bound);
            }
        }
        if (counts.nee > 1) {
            const Product light(chance(d.next_event, at_light));
            factors[1] *= std::max(factor(prefix[n - 1], light), least(counts.nee));
        }
        return true;
    }

    // Multiplies. False where a double is not enough.
    static bool extend(double& product, double by) {
        if (product == 0) return true;
        product *= by;
        return product > 0x1p-800 || by == 0;
    }
    static bool extend(Scaled& product, double by) {
        product *= by;
        return true;
    }

    // [grittmann2021 Eq. 17]
    double area_around(double d2) const {
        constexpr double kTangentOfOneDegree = 0.017455064928217585;
        const double r2 = is_global_ ? scene_radius_ * scene_radius_
                                     : d2 * kTangentOfOneDegree * kTangentOfOneDegree;
        return M_PI * scale_ * scale_ * r2;
    }
    // [grittmann2021 Eq. 13]; the last term of Eq. 15 is lost where a product needs an exponent.
    static double factor(double prefix, double rest) { return correlation_factor(prefix, rest); }
    static double factor(const Scaled& prefix, const Scaled& rest) {
        if (prefix.exponent() == 0 && rest.exponent() == 0) {
            return correlation_factor(prefix.significand(), rest.significand());
        }
        if (rest.is_zero()) return 1;
        constexpr std::int64_t kMaxShift = 4000;
        const auto shift =
            std::clamp<std::int64_t>(rest.exponent() - prefix.exponent(), -kMaxShift, kMaxShift);
        return 1 /
               (1 + std::ldexp(rest.significand() / prefix.significand(), static_cast<int>(shift)));
    }
    // [grittmann2021 Eq. 12]; a factor is above 0.
    double least(double n) const { return is_bounded_ ? 1 / n : 1e-300; }

    bool is_global_;
    double scale_;
    bool is_bounded_;
    double scene_radius_ = 0;
};

}  // namespace

void CorrelationParameters::check() const {
    check_choice("correlation_radius", radius, {"distance", "global"});
    if (!(scale > 0 && scale <= kMaxScale)) {
        throw ParameterError("correlation_scale", "correlation_scale must be above 0 and at most " +
                                                      to_string(ParameterValue(kMaxScale)));
    }
}

std::shared_ptr<FactorProvider> make_correlation(const CorrelationParameters& parameters) {
    return std::make_shared<Correlation>(parameters);
}

}  // namespace misbench
