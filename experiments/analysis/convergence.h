// Error against effort: each budget of an experiment, and each snapshot within a render, is a point
// of its method's curve.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/analysis/comparison.h"

namespace misbench {

// All seeds of a method at one effort.
struct CurvePoint {
    double passes = 0;  // samples a pixel, mean over the seeds
    double cpu_seconds = 0;
    double wall_seconds = 0;
    std::vector<double> values;  // of the metric, one a seed
    std::vector<std::int64_t> seeds;
    std::optional<Estimate> mean;
    bool is_snapshot = false;  // on the way of a longer render
};

struct Curve {
    std::string scene;
    std::string method;              // the user's label
    std::vector<CurvePoint> points;  // by growing passes; points without a value are left out
};

// For each scene and method of the plan; `metric` as in compare(). Snapshots are those of the
// longest budget that has some: of shorter ones they would be the same samples again. They are left
// out where not all seeds have them, and where a budget of as many samples is a point already.
std::vector<Curve> convergence(const Store& store, const Plan& plan,
                               const std::string& metric = "");

}  // namespace misbench
