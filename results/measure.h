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

enum class MeasureInto {
    File,
    // Tables of this connection alone. From the first measurement on they stand before those of the
    // file, of which they begin with the rows of the plan's experiment.
    Memory
};
bool measures_in_memory(const Database& database);

// See Store::measure.
int measure_plan(const Database& database, const std::filesystem::path& store, const Plan& plan,
                 MeasureInto into = MeasureInto::File);
std::vector<Measurement> select_measurements(const Database& database, const Plan& plan);
std::vector<SnapshotMeasurement> select_snapshot_measurements(const Database& database,
                                                              const Plan& plan,
                                                              const std::string& metric);

}  // namespace misbench
