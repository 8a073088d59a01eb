// Which method is biased where: for each scene the images of every method against those of one
// that is taken for unbiased, tile by tile (tile_test.h).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "experiments/plan/experiment.h"
#include "experiments/statistics/tile_test.h"
#include "results/metrics/error_parts.h"
#include "results/store.h"

namespace misbench {

struct BiasOptions {
    std::string against = {};  // a label; "" for the plan's baseline
    std::string budget =
        {};                // "16 spp"; "" for the last of the plan, to which budgets usually rise
    double margin = 0.01;  // of equivalence
    double alpha = 0.01;   // of all scenes and methods together, as a rate of false findings
};

enum class BiasFinding {
    Biased,          // at some scale, even where the whole image is equivalent
    DarkOrRare,      // too dark in tiles, but rare samples carry its light: seeds may miss them
    Negligible,      // biased, but every tile that is not dark lies within the margin
    Equivalent,      // no bias found, and the whole image lies within the margin
    NotFound,        // no bias found; what would have been is ImageTest's detectable bias
    NothingToTest,   // the same images: equal methods, or without noise
    NotEnoughSeeds,  // fewer than kFewestForInterval valid runs on either side
};
std::string to_string(BiasFinding finding);  // "biased"

// A method with more of its light in rare samples (ImageTest::rare_share) is not called biased for
// being dark where few seeds found none: no test tells that from bias.
inline constexpr double kMostInRareSamples = 0.05;

// One scene and method.
struct BiasCell {
    std::string scene;
    std::string method;
    // Of one number where the test is of pairs: seeds that both have.
    int n_seeds = 0;
    int n_seeds_against = 0;
    bool few_passes = false;  // of a run of a time budget, on either side
    BiasFinding finding = BiasFinding::NotEnoughSeeds;
    std::optional<ImageTest> test;  // absent exactly with too few seeds
    // Of the mean error of all valid seeds; absent with fewer than two and without a reference.
    std::optional<ErrorParts> parts;
    // That the method has no bias at any scale in this scene, by Benjamini and Hochberg over all
    // scenes and methods.
    double adjusted_p = 1;
    int width = 0;  // of the images
    int height = 0;
};

struct Bias {
    std::string experiment;
    std::string against;
    Budget budget;
    double margin = 0;
    double alpha = 0;
    std::string metric;           // whose parts: the plan's first squared error; "" for none
    std::vector<BiasCell> cells;  // by scene, then method, in the plan's order
};

// Adjusts the p values of cells that have a test for each other, and finds what follows from them.
void decide(std::vector<BiasCell>& cells, double alpha);

// Throws ParameterError for a method or budget that the plan does not have.
Bias find_bias(const Store& store, const Plan& plan, const BiasOptions& options);

// The z values of a scale's tiles as an image: white for none, red where the method is brighter
// than it should be, blue where it is darker, full from ±kFullColour on.
inline constexpr double kFullColour = 5;
Image bias_map(const BiasCell& cell, const ScaleTest& scale);

}  // namespace misbench
