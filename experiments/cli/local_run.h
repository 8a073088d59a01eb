// The tasks of a plan done here, by a coordinator and workers of our own, and what is said of them.
#pragma once

#include <string>

#include "experiments/cli/verbs.h"
#include "experiments/plan/experiment.h"
#include "results/store.h"

namespace misbench {

// Puts the plan into the store and does what it lacks. The fleet is of this call: only while none
// runs the store is ours to measure in. Returns when all tasks are done or failed, or no worker is
// left (true), or when interrupted (false). `progress` goes before the line of progress.
bool do_tasks(const RunOptions& options, const Plan& plan, const std::string& progress);

// Names the tasks that failed or were not done, as the user calls them. Returns whether there are
// any.
bool report_failures(const Store& store, const Plan& plan);

// Each prints, and returns the exit code: the table and the claims of a plan that was measured, and
// how much of it is there.
int print_outcome(const Store& store, const Plan& plan);
int interrupted(const Store& store, const Plan& plan, const RunOptions& options);

}  // namespace misbench
