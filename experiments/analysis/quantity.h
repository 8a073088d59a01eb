// What a table can show of a run: a metric, what it cost, and both as one number.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "experiments/plan/experiment.h"
#include "results/cell_seeds.h"
#include "results/metrics/metrics.h"

namespace misbench {

// The cost of a run that stands alone or multiplies a metric.
enum class RunCost { None, Passes, CpuSeconds, WallSeconds, Rays, SecondsPerPass };

struct Quantity {
    std::string id;
    std::string formula;
    Direction better = Direction::Less;
    std::string metric;  // one of the plan's, "" for none
    RunCost cost = RunCost::None;
    // Shown as the reciprocal of the mean, 1/(mean of error × time): a mean of reciprocals would be
    // another number, and infinite where one error is zero.
    bool is_reciprocal = false;
    // Of a cell: the largest over the median seed. It estimates nothing, so it has no interval and
    // no ratio.
    bool is_tail = false;
};

// `text` is "" for the plan's first metric, one of its metrics M, "passes", "cpu_seconds",
// "wall_seconds", "rays", "seconds_per_pass", "M*cpu", "1/(M*cpu)" or "tail(M)". Throws
// ParameterError with the known ones.
Quantity find_quantity(const Plan& plan, const std::string& text);

// Of a valid run, before it is made reciprocal or a tail. Absent where the metric is not measured.
std::optional<double> value_of(const Quantity& quantity, const CellSeeds& cell, std::size_t seed);

}  // namespace misbench
