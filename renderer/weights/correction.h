// One factor a pixel in front of each of a few groups of techniques, chosen among candidates by the
// second moments that a pass of training measured: hua2025.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "renderer/paths/factor_provider.h"

namespace misbench {

struct CorrectionParameters {
    std::string groups = "merge+light";
    std::string candidates = "0.01,0.1,0.5,1";
    std::string filter = "blur";
    std::string mean = "candidate";
    std::int64_t blur = 8;
    std::int64_t blur_mean = 8;
    std::int64_t blur_factor = 8;
    bool keep = true;

    static void fields(auto& self, auto&& field) {
        field(
            "correction_groups", self.groups,
            "what has a factor, joined by +: merge (photons, paths of three edges or more), light "
            "(light paths at the camera, of two edges), nee (shadow rays), hit (camera paths that "
            "run into light, of two edges)");
        field("correction_candidates", self.candidates,
              "factors to choose from, above 0; 1, which is always one, wins ties");
        field("correction_filter", self.filter,
              "of the moments: blur, bilateral (by normals and distances), none (for precomputed "
              "moments)");
        field("correction_mean", self.mean,
              "what a candidate's moment is relative to: its own mean (candidate), as the authors' "
              "program, or the image (image), as their text");
        field("correction_blur", self.blur, "passes of a 3×3 box filter over the moments");
        field("correction_blur_mean", self.blur_mean, "over the means");
        field("correction_blur_factor", self.blur_factor, "over the chosen factors");
        field("correction_keep", self.keep, "the image keeps the samples of training");
    }
    void check() const;
};

std::shared_ptr<FactorProvider> make_correction(const CorrectionParameters& parameters);

}  // namespace misbench
