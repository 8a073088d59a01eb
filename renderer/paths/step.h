// How a subpath goes on from a vertex, from the camera and from a light alike.
#pragma once

#include <cmath>
#include <optional>

#include "renderer/base/check.h"
#include "renderer/base/rng.h"
#include "renderer/scene/bsdf.h"

namespace misbench {

struct Step {
    Vec3 wi;
    Rgb weight;  // f cosθ / p
    // Of sampling wi given wo, and of sampling wo given wi; solid angle measure. Of a delta lobe,
    // the factors of its Dirac density that path_densities.h asks for.
    double pdf_forward = 0;
    double pdf_reverse = 0;
    bool is_delta = false;
    float eta = 1;
};

// wo is the direction that `bsdf` was made for. The reverse density is computed only where wanted.
// Absent where the path ends.
template <class Bsdf>
std::optional<Step> sample_step(const Bsdf& bsdf, const SurfacePoint& point, Vec3 wo, Rng& rng,
                                bool wants_reverse) {
    const float lobe = rng.uniform();
    const float u = rng.uniform();
    const auto sample = bsdf.sample({lobe, {u, rng.uniform()}});
    if (!sample) return std::nullopt;
    MISBENCH_CHECK(sample->pdf > 0);
    Step step{.wi = sample->wi,
              .weight = sample->weight,
              .pdf_forward = sample->pdf,
              .is_delta = sample->is_delta,
              .eta = sample->eta};
    if (!wants_reverse) return step;
    if (!sample->is_delta) {
        step.pdf_reverse = bsdf.reverse_pdf(sample->wi);
        return step;
    }
    step.pdf_reverse = sample->pdf;
    if (sample->eta != 1) {
        // η_i² |cos θ_i| dω_i = η_o² |cos θ_o| dω_o: the Dirac densities of wi given wo and of wo
        // given wi differ by dω_o / dω_i. Each gets one half of it, so that both sides of the path
        // find the same numbers.
        const double cos_i = std::abs(double{dot(point.shading_normal, sample->wi)});
        const double cos_o = std::abs(double{dot(point.shading_normal, wo)});
        const double half = double{sample->eta} * std::sqrt(cos_i / cos_o);
        step.pdf_forward *= half;
        step.pdf_reverse /= half;
    }
    return step;
}

}  // namespace misbench
