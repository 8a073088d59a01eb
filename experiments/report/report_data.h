// The numbers of a report as its scripts read them: everything that tables and charts show on
// demand.
#pragma once

#include <nlohmann/json.hpp>

#include "experiments/plan/experiment.h"
#include "results/store.h"

namespace misbench {

// Scenes with their exposures, methods, budgets, baseline; for each metric its comparison, as
// `misbench table --format json` prints it, and its curves of error over effort.
nlohmann::ordered_json report_data(const Store& store, const Plan& plan);

// As the content of a script element, which ends at "</script" whatever surrounds it.
std::string embedded_json(const nlohmann::ordered_json& json);

}  // namespace misbench
