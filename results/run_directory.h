// The files of a store, without its database: what a run's folder and an experiment's file hold and
// whether they are whole.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "experiments/plan/experiment.h"
#include "results/record.h"

namespace misbench {

inline constexpr const char* kRecordFile = "record.json";
inline constexpr const char* kImageFile = "image.exr";

// Throws DataLoss with the path when the record is missing or damaged.
Record read_record(const std::filesystem::path& run_folder);

// Also checks that the images are the ones the record is about.
Record read_whole_run(const std::filesystem::path& run_folder);

struct ExperimentFile {
    Plan plan;
    std::int64_t submitted_at_ms = 0;
    std::string sha256;  // of the file's bytes
};

// experiments/NAME.json. A name is a file's name: letters, digits, dot, dash, underscore; throws
// InvalidArgument for any other.
std::filesystem::path experiment_path(const std::filesystem::path& store, const std::string& name);
ExperimentFile read_experiment_file(const std::filesystem::path& path);
// Returns what was written.
ExperimentFile write_experiment_file(const std::filesystem::path& store, const Plan& plan,
                                     std::int64_t submitted_at_ms);

}  // namespace misbench
