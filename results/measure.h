// From images to measurements: which numbers a plan lacks, and computing them.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "experiments/plan/experiment.h"
#include "results/sqlite.h"
#include "results/store.h"

namespace misbench {

// See Store::measure.
int measure_plan(const Database& database, const std::filesystem::path& store, const Plan& plan);
std::vector<Measurement> select_measurements(const Database& database, const Plan& plan);
std::vector<SnapshotMeasurement> select_snapshot_measurements(const Database& database,
                                                              const Plan& plan,
                                                              const std::string& metric);

}  // namespace misbench
