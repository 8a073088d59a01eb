// What a panel asks of the store, with its names checked against the experiment.
#pragma once

#include <string>
#include <vector>

#include "experiments/analysis/comparison.h"
#include "experiments/figure/figure_file.h"
#include "results/store.h"

namespace misbench::figure {

inline constexpr const char* kReference = "reference";

struct Query {
    Plan plan;
    Comparison comparison;
    std::vector<SceneEntry> scenes;    // those of the panel, or all
    std::vector<std::string> methods;  // the same; kReference may be among them
    std::vector<Budget> budgets;       // the panel's one, or all
};

// With `one_budget` there must be one: the panel's, or the experiment's only one. Throws
// InvalidArgument with the place of a name that the experiment does not have.
Query ask(const Store& store, const Panel& panel, bool one_budget, bool with_reference);

// The method and metric as a caption names them: "relMSE" for "relmse.eps0.01".
std::string short_name_of_metric(const std::string& id);

}  // namespace misbench::figure
