// A laboratory file and what comes of it: for every problem and weighting the exact moments beside
// sampled ones, and which of the file's expectations hold.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "experiments/lab/weights.h"
#include "experiments/statistics/intervals.h"

namespace misbench::lab {

// Errors are variance + bias² of one draw of all samples: of n draws together n times theirs.

// factor × (error of `less`) < error of `more`
struct LessError {
    std::string less;
    std::string more;
    double factor = 1;
};
// |error of a - error of b| <= within × error of b
struct EqualError {
    std::string a;
    std::string b;
    double within = 0;
};
// The weight of a technique at x is less with one weighting than with another.
struct LessWeight {
    std::string less;
    std::string more;
    std::string technique;
    double at = 0;
};
// A technique has a weight below 0 somewhere.
struct NegativeWeight {
    std::string weighting;
};

struct Expectation {
    std::string claim;  // in words
    std::variant<LessError, EqualError, LessWeight, NegativeWeight> test;
    std::string note;  // why, where it does not hold
};

struct Case {
    Problem problem;
    std::vector<Weighting> weightings;
    std::vector<Expectation> expectations;
};

struct Study {
    std::string name;
    std::string description;
    std::int64_t seed = 1;
    int runs = 0;  // estimates of each weighting; 0 for none
    std::vector<Case> cases;
};

struct Outcome {
    std::optional<FixedWeights> weights;  // absent where they follow from the samples
    std::optional<Moments> exact;         // of fixed weights
    // Of one draw, as errors are; absent without runs.
    std::optional<Estimate> sampled_variance;
    std::optional<Estimate> sampled_bias;
    std::optional<double> error;        // exact, else sampled
    std::optional<double> error_ratio;  // over the balance heuristic's, if that has one
};

struct Verdict {
    bool holds = false;
    std::string found;  // "0.0123 < 0.0456"
};

struct CaseOutcome {
    double integral = 0;
    std::vector<Outcome> outcomes;  // of the weightings
    std::vector<Verdict> verdicts;  // of the expectations
};

CaseOutcome examine(const Case& of, std::int64_t seed, int runs);

// The estimates of one weighting: runs × (its iterations) draws.
std::vector<double> sample_estimates(const Problem& problem, const Weighting& weighting,
                                     const std::optional<FixedWeights>& weights, std::int64_t seed,
                                     int runs);

}  // namespace misbench::lab
