// Metals: a smooth mirror and a rough one, by complex refractive index.
//
// [WMLT07]  B. Walter et al., Microfacet models for refraction through rough surfaces, 2007.
#pragma once

#include "renderer/scene/material_model.h"
#include "renderer/scene/microfacets.h"

namespace misbench {

// One delta lobe.
class ConductorMaterial {
 public:
    static constexpr std::string_view kType = "conductor";

    struct Parameters {
        // Refractive index and extinction over the refractive index outside; eta 0 with any k
        // reflects everything.
        Rgb eta{0, 0, 0};
        Rgb k{1, 1, 1};
        Rgb specular_reflectance{1, 1, 1};
    };
    explicit ConductorMaterial(const Parameters& parameters) : parameters_(parameters) {}

    Lobes lobes() const { return kDeltaLobe; }
    BsdfValue evaluate(const Encounter& e, Vec3 wi) const;
    std::optional<BsdfSample> sample(const Encounter& e, BsdfRandom u) const;
    void set_color(Rgb color) { parameters_.specular_reflectance = color; }

 private:
    Parameters parameters_;
};

class RoughConductorMaterial {
 public:
    static constexpr std::string_view kType = "rough conductor";

    struct Parameters {
        Rgb eta{0, 0, 0};  // as above
        Rgb k{1, 1, 1};
        Rgb specular_reflectance{1, 1, 1};
        Microfacets distribution = Microfacets::Beckmann;
        float alpha = 0.1F;  // 1e-4 to 1
    };
    explicit RoughConductorMaterial(const Parameters& parameters) : parameters_(parameters) {}

    Lobes lobes() const { return kGlossyLobe; }
    BsdfValue evaluate(const Encounter& e, Vec3 wi) const;
    std::optional<BsdfSample> sample(const Encounter& e, BsdfRandom u) const;
    void set_color(Rgb color) { parameters_.specular_reflectance = color; }

 private:
    Parameters parameters_;
};

}  // namespace misbench
