// From the beginning of an id, as tables and errors print it, to a run of a store.
#pragma once

#include <string>

#include "results/store.h"

namespace misbench {

// The id of the run that begins so. Throws InvalidArgument with those that are nearest.
std::string find_run(const Store& store, const std::string& beginning);
// The same of runs and of tasks that are in the job table.
std::string find_run_or_task(const Store& store, const std::string& beginning);

}  // namespace misbench
