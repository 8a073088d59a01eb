// The runs that a comparison shows of a scene: images, maps of their errors, where to look.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "experiments/figure/query.h"
#include "results/metrics/metrics.h"

namespace misbench::figure {

// The runs of one method in one scene; of the reference its mean.
struct View {
    std::string method;
    std::optional<Image> image = {};        // of the seed that is shown
    std::vector<ValueMap> maps = {};        // of the error, one a seed
    std::vector<std::int64_t> seeds = {};   // of the maps
    std::optional<ValueMap> mean_map = {};  // over the seeds
    const ComparedCell* cell = nullptr;     // of the query

    bool is_baseline() const { return cell != nullptr && cell->is_baseline; }
};

// The errors in a part of the image.
struct PartNumbers {
    Window window;
    std::vector<ComparedCell> cells = {};  // as the methods
    std::optional<std::size_t> best = {};
};

struct SceneViews {
    std::string scene;
    double exposure = 0;
    int width = 0;
    int height = 0;
    std::vector<View> views = {};  // as the methods
    std::vector<Window> crops = {};
    bool crops_are_automatic = false;
    std::vector<PartNumbers> parts = {};   // the crops, or the whole image where there are none
    std::optional<std::size_t> best = {};  // of the whole image, by the panel's metric

    Window whole() const { return {0, 0, width, height}; }
};

// What is measured of the pixels: by no metric where there is none.
struct PixelQuestion {
    Budget budget;
    const Metric* metric = nullptr;  // has a map
    bool with_maps = false;          // of the whole image, also without crops
};

// Throws InvalidArgument with the place of crops that cannot be.
SceneViews look_at(const Store& store, const Query& query, const SceneEntry& entry,
                   const std::optional<Crops>& crops, const PixelQuestion& question);

// The seeds' errors in a window, in the shape that statistics of cells have.
PartNumbers numbers_of(const SceneViews& scene, const Window& window);

}  // namespace misbench::figure
