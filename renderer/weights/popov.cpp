#include "renderer/weights/popov.h"

namespace misbench {
namespace {

class Popov final : public FactorProvider {
 public:
    // 1/n_t: the lower bound of grittmann2021 Eq. 12.
    void multiply(const PathView& path, const TechniqueCounts& counts,
                  std::span<double> factors) const override {
        const int n = path.n_edges();
        if (n < 2) return;
        const auto divide = [&](Technique technique, double n_t) {
            if (n_t > 1) factors[static_cast<std::size_t>(technique.index(n))] /= n_t;
        };
        divide({TechniqueKind::NextEvent}, counts.nee);
        for (int k = 1; k < n; ++k) divide({TechniqueKind::Merge, k}, counts.merge);
    }
};

}  // namespace

std::shared_ptr<FactorProvider> make_popov() { return std::make_shared<Popov>(); }

}  // namespace misbench
