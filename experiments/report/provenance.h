// Where the numbers of an experiment come from: machines and builds, as its runs recorded them.
#pragma once

#include <string>
#include <vector>

#include "experiments/plan/experiment.h"
#include "results/store.h"

namespace misbench {

// The runs of one machine and one build.
struct Origin {
    Provenance provenance;
    int threads = 0;
    int n_runs = 0;
};

// Of the tested runs; references do not decide times.
std::vector<Origin> origins(const Store& store, const Plan& plan);

// One line for each, and a warning when there are several.
std::vector<std::string> provenance_lines(const std::vector<Origin>& origins);

// Those of the plan's runs, and which scenes have a single image as both halves of the reference.
std::vector<std::string> provenance_lines(const Store& store, const Plan& plan);

}  // namespace misbench
