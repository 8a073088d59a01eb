// How two stores differ in the experiments that both have: what is missing in one, which runs have
// other images, which means differ by more than chance.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "experiments/analysis/comparison.h"
#include "results/record.h"

namespace misbench {

// All seeds of a scene, method and budget, or a half of a reference.
struct DiffPlace {
    std::string experiment;
    std::string scene;
    std::string method;  // a label; "reference_a", "reference_b"
    std::string budget;
    auto operator<=>(const DiffPlace&) const = default;
};
using DiffSeeds = std::map<DiffPlace, std::vector<std::int64_t>>;

// Both have finished the place with different tasks, by how those differ: it is not the same
// experiment.
using DiffTasks = std::map<std::pair<DiffPlace, std::string>, std::vector<std::int64_t>>;

// One task, two images.
struct DiffImage {
    DiffPlace place;
    std::int64_t seed = 0;
    std::string run;
    // At equal samples an image follows from its task, whatever machine renders it: this is a
    // failure to reproduce. At equal time it is what has to be expected.
    bool must_be_equal = false;
    Record a;
    Record b;
};

struct DiffMean {
    DiffPlace place;
    Estimate ratio;  // mean in A / mean in B, with a simultaneous interval
    bool is_paired = false;
    bool is_identical = false;  // value by value

    bool differs() const { return !is_identical && excludes_one(ratio); }
};

struct StoreDiff {
    std::vector<std::string> experiments;  // in both
    std::vector<std::string> only_a;       // experiments
    std::vector<std::string> only_b;
    DiffSeeds runs_only_a;  // finished there and not here
    DiffSeeds runs_only_b;
    DiffTasks tasks;
    int n_equal_images = 0;
    std::vector<DiffImage> images;
    std::vector<DiffMean> means;

    // Nothing is missing on either side, and nothing differs but images at equal time.
    bool is_same() const;
};

// Each interval of a ratio is one of a share of 5 % / number of means (Bonferroni), so that equal
// stores have a significant difference in at most 5 % of all comparisons. `experiment` "" means all
// that are in both; `metric` as in compare(). Throws NotFound where a store has no such experiment.
StoreDiff diff_stores(const Store& a, const Store& b, const std::string& experiment,
                      const std::string& metric);

}  // namespace misbench
