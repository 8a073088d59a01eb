// The images of a report: which of a plan's there are, what is said of each, and their pixels.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

#include "experiments/analysis/comparison.h"
#include "experiments/plan/experiment.h"
#include "experiments/report/pixel_block.h"
#include "results/store.h"

namespace misbench {

// Beside the mean over the seeds of each cell.
enum class SeedImages { None, First, All };
SeedImages seed_images_from_string(const std::string& text);  // "none", "first", "all"

struct ReportImages {
    // What viewer.js reads. Of each image its scene, method and budget (indices into the plan's,
    // null for the reference), seed (a number, "mean" or null), caption and block; of each block
    // its size, precision and scale.
    nlohmann::ordered_json images = nlohmann::ordered_json::array();
    nlohmann::ordered_json blocks = nlohmann::ordered_json::array();
    std::string html;  // the blocks' pixels, an element each, in the order of the scenes
};

// `comparison` is the plan's by the metric that captions tell.
ReportImages collect_images(const Store& store, const Plan& plan, const Comparison& comparison,
                            SeedImages seeds, Precision precision);

}  // namespace misbench
