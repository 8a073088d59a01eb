// What an experiment says: scene × method × budget as values. Text tables, JSON and the report are
// all printed from this, so that they cannot differ.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "experiments/plan/experiment.h"
#include "experiments/statistics/intervals.h"
#include "results/metrics/metrics.h"
#include "results/store.h"

namespace misbench {

// A largest seed beyond this multiple of the median one says that rare samples carry the error:
// at few seeds no interval is honest then.
inline constexpr double kHeavyTail = 3;

// One cell of the table: all seeds of one scene, method and budget.
struct ComparedCell {
    std::string scene;
    std::string method;  // the user's label
    Budget budget;

    // Seeds, by what became of them: n_planned is the sum of the five others.
    int n_planned = 0;
    int n_measured = 0;      // valid, and its error is known: all numbers below are over these
    int n_invalid = 0;       // has non-finite samples, or negative ones that are not declared
    int n_failed = 0;        // given up by the queue
    int n_unfinished = 0;    // waiting or in work
    int n_unreferenced = 0;  // valid, but its reference is missing, invalid or not yet compared

    std::vector<double> values;       // of the metric, in the order of the plan's seeds
    std::vector<std::int64_t> seeds;  // of `values`
    std::optional<Estimate> mean;     // absent without measured seeds
    // mean / mean of the baseline in the same scene and budget, over the same seeds where it is
    // paired. Absent for the baseline itself,
    // when one of the two has no measured seeds and when a mean is not positive.
    std::optional<Estimate> ratio;
    bool ratio_is_paired = false;
    // Largest over median value: absent below kFewestForInterval seeds and for a median that is
    // not positive.
    std::optional<double> tail;
    bool is_baseline = false;
    bool few_passes = false;  // a run of a time budget ended after fewer than kFewPasses passes
    double mean_passes = 0;   // samples a pixel
    double mean_wall_seconds = 0;
    double mean_cpu_seconds = 0;

    bool is_complete() const { return n_measured == n_planned; }
    bool ratio_excludes_one() const { return ratio && excludes_one(*ratio); }
    bool has_heavy_tail() const { return tail && *tail > kHeavyTail; }
};

// All seeds of the one are the other's too, so that their values come in pairs.
bool are_paired(const ComparedCell& a, const ComparedCell& b);
// log(mean(a)/mean(b)), of pairs where there are, over the seeds that both have. Absent like
// ComparedCell::ratio.
std::optional<LogRatio> log_ratio(const ComparedCell& a, const ComparedCell& b);

// "4 of 5 seeds: 1 failed"; "" when all seeds are measured.
std::string status_of(const ComparedCell& cell);

struct Comparison {
    std::string experiment;
    std::string metric;
    std::string formula;  // of the metric
    Direction better = Direction::Less;
    std::string baseline;
    std::optional<SeedRule> seed_rule = std::nullopt;  // of the plan
    std::string rule_metric = {};                      // whose ratios the rule is about
    std::vector<std::string> scenes;                   // as in the plan
    std::vector<std::string> methods;                  // as in the plan
    std::vector<Budget> budgets;                       // as in the plan, or the one asked for
    std::vector<ComparedCell> cells;  // by scene, then budget, then method; excluded ones left out

    // Null where the experiment excludes the combination.
    const ComparedCell* find(const std::string& scene, const std::string& method,
                             const Budget& budget) const;
};

// `metric` "" means the plan's first; kSecondsPerPass stands beside the plan's own. Throws
// ParameterError when the plan does not measure `metric` or does not use `budget`, with the list of
// those it has.
Comparison compare(const Store& store, const Plan& plan, const std::string& metric = "",
                   const std::optional<Budget>& budget = std::nullopt);

}  // namespace misbench
