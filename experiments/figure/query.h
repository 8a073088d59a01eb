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
};

// Throws InvalidArgument with the place of a name that the experiment does not have.
Query ask(const Store& store, const Panel& panel, bool with_reference);

// Throws InvalidArgument at the first title of a panel whose name is not among `known`.
void require_titles_of(const Panel& panel, const std::vector<std::string>& known);

// The panel's budget, or the experiment's only one. Throws InvalidArgument where there is none or
// not just one.
Budget budget_of(const Query& query, const Panel& panel);

// A metric as captions name it: "relMSE" for "relmse.eps0.01".
std::string short_name_of_metric(const std::string& id);

}  // namespace misbench::figure
