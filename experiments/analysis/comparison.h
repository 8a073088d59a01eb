// What an experiment says: scene × method × budget as values. Text tables, JSON and the report are
// all printed from this, so that they cannot differ.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiments/analysis/quantity.h"
#include "experiments/plan/experiment.h"
#include "experiments/statistics/intervals.h"
#include "experiments/statistics/tail.h"
#include "renderer/base/parameters.h"
#include "results/metrics/metrics.h"
#include "results/reference_noise.h"
#include "results/store.h"

namespace misbench {

// One cell of the table: all seeds of one scene, method and budget.
struct ComparedCell {
    std::string scene;
    std::string method;  // the user's label
    Budget budget;
    ParameterMap parameters;  // effective ones of the method

    // Seeds, by what became of them: n_planned is the sum of the five others.
    int n_planned = 0;
    int n_measured = 0;      // valid, and its error is known: all numbers below are over these
    int n_invalid = 0;       // has non-finite samples, or negative ones that are not declared
    int n_failed = 0;        // given up by the queue
    int n_unfinished = 0;    // waiting or in work
    int n_unreferenced = 0;  // valid, but its reference is missing, invalid or not yet compared

    // Of the quantity (of a reciprocal one, before it is made that), in the order of the plan's
    // seeds.
    std::vector<double> values;
    std::vector<std::int64_t> seeds;  // of `values`
    std::optional<Estimate> mean;     // absent without measured seeds
    // mean / mean of the baseline in the same scene and budget, over the same seeds where it is
    // paired. Absent for the baseline itself,
    // when one of the two has no measured seeds and when a mean is not positive.
    std::optional<Estimate> ratio;
    bool ratio_is_paired = false;
    std::optional<LogRatio> ratio_log;  // what `ratio` is made of
    // Of the test that the ratio is one, where it has an interval or is an identity; adjusted for
    // all ratios of the comparison by Benjamini and Hochberg, but not where they are to the best.
    std::optional<double> p;
    std::optional<double> adjusted_p;
    // Largest over median value: absent below kFewestForInterval seeds and for a median that is
    // not positive.
    std::optional<double> tail;
    // Of the values, with the scene and method's other budgets as kin. Where it is dishonest there
    // is no interval of the mean, nor of any ratio that it is in.
    TailVerdict tail_verdict = TailVerdict::Calm;
    // Of the reference's noise in the error, over all seeds; absent for what is no error.
    std::optional<double> reference_share;
    bool is_baseline = false;
    bool is_mean_of_scenes = false;  // has a ratio and nothing else (scene_means.h)
    bool few_passes = false;  // a run of a time budget ended after fewer than kFewPasses passes
    double mean_passes = 0;   // samples a pixel
    double mean_wall_seconds = 0;
    double mean_cpu_seconds = 0;

    bool is_complete() const { return n_measured == n_planned; }
    bool ratio_excludes_one() const { return ratio && excludes_one(*ratio); }
    // The difference survives that many are looked at: a share of 5 % of those that a table marks
    // is expected to be chance.
    bool differs() const { return adjusted_p && *adjusted_p <= 1 - kConfidence; }
    bool has_heavy_tail() const { return tail_verdict == TailVerdict::Heavy; }
    bool has_noisy_reference() const { return reference_share > kNoisyReference; }
};

// All seeds of the one are the other's too, so that their values come in pairs.
bool are_paired(const ComparedCell& a, const ComparedCell& b);
// log(mean(a)/mean(b)), of pairs where there are, over the seeds that both have. Absent like
// ComparedCell::ratio; it says nothing but its value where the tail of one of the two is dishonest.
std::optional<LogRatio> log_ratio(const ComparedCell& a, const ComparedCell& b);
// The ratio with its interval by the bootstrap-t: a check of log_ratio's. Absent like it.
std::optional<Estimate> bootstrap_ratio(const ComparedCell& a, const ComparedCell& b);

// "4 of 5 seeds: 1 failed"; "" when all seeds are measured.
std::string status_of(const ComparedCell& cell);

// The plan's seed rule, and the ratios that it is about.
struct ComparedRule {
    SeedRule rule;
    std::string metric;
    std::string baseline;
    bool is_of_these = false;  // they are those of the comparison, over all seeds
};

struct Comparison {
    std::string experiment;
    std::string metric;
    std::string formula;  // of the metric
    Direction better = Direction::Less;
    std::string baseline;  // what ratios are to: a label, kToBest or kToNone
    std::optional<ComparedRule> seed_rule = std::nullopt;
    std::vector<std::string> scenes;   // as in the plan; then those of scene_means.h, if any
    std::vector<std::string> methods;  // as in the plan
    std::vector<Budget> budgets;       // as in the plan, or the one asked for
    std::vector<ComparedCell> cells;   // by scene, then budget, then method; excluded ones left out

    // Null where the experiment excludes the combination.
    const ComparedCell* find(const std::string& scene, const std::string& method,
                             const Budget& budget) const;
};

// The best mean of the same scene and budget, by the same runs: such ratios are a ranking, and
// their intervals are too favourable to the best.
inline constexpr const char* kToBest = "best";
inline constexpr const char* kToNone = "none";

struct Question {
    std::string quantity;          // see find_quantity()
    std::optional<Budget> budget;  // absent: all of the plan
    std::string ratio_to;          // "" for the plan's baseline, or as Comparison::baseline
    std::string where;             // a Filter over scene, method, budget, seed, passes, seconds (of
                                   // CPU time), value and parameters; "" for all
};

// REQUIRES: the store has the plan's experiment; the cells are read from there, so the plan's head
// will do. Throws ParameterError when the plan does not have what is asked for, with the list of
// what it has.
Comparison compare(const Store& store, const Plan& plan, const Question& question);
Comparison compare(const Store& store, const Plan& plan, const std::string& metric = "",
                   const std::optional<Budget>& budget = std::nullopt);

// Adjusts the p values of all of them together: those of one table.
void adjust_p_values(std::span<Comparison> comparisons);

// Computes the ratios to the plan's baseline of all of its metrics and keeps them in the store.
void store_comparisons(Store& store, const Plan& plan);

}  // namespace misbench
