// The images behind a comparison's cells: what figures and reports show.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "experiments/plan/experiment.h"
#include "renderer/image/image.h"
#include "results/store.h"

namespace misbench {

// Valid, finished runs of one scene, method and budget.
struct CellRun {
    std::int64_t seed = 0;
    std::string run;  // its id
};
// In the order of the plan's seeds; empty where nothing is finished.
std::vector<CellRun> finished_runs(const Store& store, const Plan& plan, const std::string& scene,
                                   const std::string& method, const Budget& budget);

// The mean over the images of these runs; absent without runs.
std::optional<Image> mean_image(const Store& store, const std::vector<CellRun>& runs);
// Of that mean, by pixel and channel, from the spread over the runs; absent with fewer than two.
std::optional<Image> standard_error_image(const Store& store, const std::vector<CellRun>& runs);

struct ReferenceImages {
    Image a;
    Image b;
    Image mean;
};
// What the plan compares images of the scene with; absent while a half is missing or invalid.
std::optional<ReferenceImages> reference_images(const Store& store, const Plan& plan,
                                                const std::string& scene);

}  // namespace misbench
