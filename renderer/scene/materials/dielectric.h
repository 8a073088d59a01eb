// Glass: a smooth boundary, a thin pane, a rough boundary.
//
// [WMLT07]  B. Walter et al., Microfacet models for refraction through rough surfaces, 2007.
#pragma once

#include "renderer/scene/material_model.h"
#include "renderer/scene/microfacets.h"

namespace misbench {

// Two delta lobes, reflection and refraction.
class DielectricMaterial {
 public:
    static constexpr std::string_view kType = "dielectric";

    struct Parameters {
        float eta = 1.5F;  // inside over outside, > 0
        Rgb specular_reflectance{1, 1, 1};
        Rgb specular_transmittance{1, 1, 1};
    };
    explicit DielectricMaterial(const Parameters& parameters) : parameters_(parameters) {}

    Lobes lobes() const { return kDeltaLobe | kTransmissiveLobe; }
    BsdfValue evaluate(const Encounter& e, Vec3 wi) const;
    std::optional<BsdfSample> sample(const Encounter& e, BsdfRandom u) const;
    void set_color(Rgb color) { parameters_.specular_transmittance = color; }

 private:
    Parameters parameters_;
};

// A pane with two parallel boundaries, of no thickness: light goes straight on, all reflections
// between the boundaries summed.
class ThinDielectricMaterial {
 public:
    static constexpr std::string_view kType = "thin dielectric";

    using Parameters = DielectricMaterial::Parameters;
    explicit ThinDielectricMaterial(const Parameters& parameters) : parameters_(parameters) {}

    Lobes lobes() const { return kDeltaLobe | kTransmissiveLobe; }
    BsdfValue evaluate(const Encounter& e, Vec3 wi) const;
    std::optional<BsdfSample> sample(const Encounter& e, BsdfRandom u) const;
    void set_color(Rgb color) { parameters_.specular_transmittance = color; }

 private:
    Parameters parameters_;
};

class RoughDielectricMaterial {
 public:
    static constexpr std::string_view kType = "rough dielectric";

    struct Parameters {
        // Inside over outside, > 0. Within 1e-4 of one, light passes straight on, a delta lobe.
        float eta = 1.5F;
        Rgb specular_reflectance{1, 1, 1};
        Rgb specular_transmittance{1, 1, 1};
        Microfacets distribution = Microfacets::Beckmann;
        float alpha = 0.1F;  // 1e-4 to 1
    };
    explicit RoughDielectricMaterial(const Parameters& parameters) : parameters_(parameters) {}

    Lobes lobes() const;
    BsdfValue evaluate(const Encounter& e, Vec3 wi) const;
    std::optional<BsdfSample> sample(const Encounter& e, BsdfRandom u) const;
    void set_color(Rgb color) { parameters_.specular_transmittance = color; }

 private:
    Parameters parameters_;
};

}  // namespace misbench
