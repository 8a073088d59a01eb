// From an experiment file to a plan: every name is looked up in the renderer's catalogues, every
// default filled in, every cell given its task.
#pragma once

#include <cstddef>
#include <filesystem>

#include "experiments/plan/experiment.h"
#include "experiments/plan/experiment_file.h"

namespace misbench {

// A plan travels to the coordinator in one message (proto/limits.h).
inline constexpr std::size_t kMaxCells = 80'000;

// Parameters of a cell: the method's defaults, then those of its label, then those of its scene
// where the method declares them. Scenes by name come from `scenes`. Throws InvalidArgument with
// the place of what is wrong and the list of what is known.
Plan resolve(const ExperimentYaml& file, const std::filesystem::path& scenes);

}  // namespace misbench
