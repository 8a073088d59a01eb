#include "experiments/analysis/convergence.h"

#include <algorithm>

namespace misbench {

std::vector<Curve> convergence(const Store& store, const Plan& plan, const std::string& metric) {
    const Comparison comparison = compare(store, plan, metric);
    std::vector<Curve> curves;
    for (const std::string& scene : comparison.scenes) {
        for (const std::string& method : comparison.methods) {
            Curve curve{.scene = scene, .method = method, .points = {}};
            for (const Budget& budget : comparison.budgets) {
                const ComparedCell* cell = comparison.find(scene, method, budget);
                if (cell == nullptr || cell->values.empty()) continue;
                curve.points.push_back({.passes = cell->mean_passes,
                                        .cpu_seconds = cell->mean_cpu_seconds,
                                        .wall_seconds = cell->mean_wall_seconds,
                                        .values = cell->values,
                                        .seeds = cell->seeds,
                                        .mean = cell->mean});
            }
            std::ranges::sort(curve.points, {}, &CurvePoint::passes);
            if (!curve.points.empty()) curves.push_back(std::move(curve));
        }
    }
    return curves;
}

}  // namespace misbench
