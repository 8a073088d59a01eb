// The laboratory's YAML file; README.md beside this lists its keys.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/lab/study.h"

namespace misbench::lab {

inline constexpr int kMaxRuns = 10'000'000;
inline constexpr int kMaxSamples = 1000;  // of one technique
inline constexpr int kMaxCells = 1000;
inline constexpr int kMaxPilot = 1'000'000;
inline constexpr int kMaxIterations = 100'000;
inline constexpr std::size_t kMaxOptimal = 64;   // techniques of optimal weights, strata apart
inline constexpr double kMaxCombinations = 1e6;  // of candidates

// Each override is PATH=VALUE, as of an experiment. Throws InvalidArgument with the place, NotFound
// for the file.
Study read_study(const std::filesystem::path& file, const std::vector<std::string>& overrides);

}  // namespace misbench::lab
