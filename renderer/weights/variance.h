// Factors of each technique by its second moment over its variance, estimated from passes of
// training: grittmann2019.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "renderer/paths/factor_provider.h"

namespace misbench {

struct VarianceParameters {
    std::string variant = "grittmann2019";
    std::string factor = "ratio";
    std::int64_t tile = 8;
    std::int64_t blur = 0;
    std::int64_t max_depth = 10;
    double keep = 2;
    bool update = false;

    static void fields(auto& self, auto&& field) {
        field("variance_variant", self.variant,
              "which techniques, by whom: grittmann2019 (all, by path length), grittmann2021 "
              "(merging by path length and place), hua2025 (those, and all of direct light), "
              "hua2025-light (those, but of direct light the light tracer only)");
        field("variance_factor", self.factor,
              "ratio of second moment and variance, or reciprocal of the variance, for "
              "mis=constant");
        field("variance_tile", self.tile,
              "side in pixels of the tiles over which grittmann2019 estimates; of any size");
        field(
            "variance_blur", self.blur,
            "passes of a 3×3 box filter that estimate instead, as hua2025 does; 0: tiles, or what "
            "the variant has");
        field("variance_max_depth", self.max_depth, "edges of the longest paths that have factors");
        field("variance_keep", self.keep,
              "tiles keep the samples of training where no factor is above this; blurred ones all");
        field("variance_update", self.update, "learn from every pass, without end");
    }
    void check() const;
};

std::shared_ptr<FactorProvider> make_variance(const VarianceParameters& parameters);

}  // namespace misbench
