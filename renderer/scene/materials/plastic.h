// A diffuse base under a dielectric coating: smooth, with a delta lobe, or rough. Light that is
// reflected back inside the coating is summed.
//
// [EHR73]  W. G. Egan, T. W. Hilgeman, J. Reichman, Determination of absorption and scattering
//          coefficients for nonhomogeneous media, 1973.
#pragma once

#include <array>

#include "renderer/scene/material_model.h"
#include "renderer/scene/microfacets.h"

namespace misbench {

class PlasticMaterial {
 public:
    static constexpr std::string_view kType = "plastic";

    struct Parameters {
        float eta = 1.49F;  // of the coating over the outside, > 1
        Rgb diffuse_reflectance{0.5F, 0.5F, 0.5F};
        Rgb specular_reflectance{1, 1, 1};
        bool nonlinear = false;  // internal reflections take the base's colour each time
    };
    explicit PlasticMaterial(const Parameters& parameters);

    Lobes lobes() const { return kDiffuseLobe | kDeltaLobe; }
    BsdfValue evaluate(const Encounter& e, Vec3 wi) const;
    std::optional<BsdfSample> sample(const Encounter& e, BsdfRandom u) const;
    void set_color(Rgb color);

 private:
    float specular_probability(float boundary) const;  // by the reflectance of the boundary

    Parameters parameters_;
    float internal_reflectance_;  // diffuse, from inside the coating
    Rgb base_;                    // π f without the transmittances on the way in and out
};

class RoughPlasticMaterial {
 public:
    static constexpr std::string_view kType = "rough plastic";

    struct Parameters {
        float eta = 1.49F;  // of the coating over the outside, > 1
        Rgb diffuse_reflectance{0.5F, 0.5F, 0.5F};
        Rgb specular_reflectance{1, 1, 1};
        bool nonlinear = false;
        Microfacets distribution = Microfacets::Beckmann;
        float alpha = 0.1F;  // 1e-4 to 1
    };
    explicit RoughPlasticMaterial(const Parameters& parameters);

    Lobes lobes() const { return kDiffuseLobe | kGlossyLobe; }
    BsdfValue evaluate(const Encounter& e, Vec3 wi) const;
    std::optional<BsdfSample> sample(const Encounter& e, BsdfRandom u) const;
    void set_color(Rgb color);

 private:
    static constexpr std::size_t kTableSize = 64;

    float transmittance(float cos_theta) const;
    float specular_probability(float transmittance) const;

    Parameters parameters_;
    std::array<float, kTableSize> transmittance_{};  // of the rough boundary, cos θ from 0 to 1
    float internal_reflectance_ = 0;                 // diffuse, from inside the coating
    Rgb base_;  // π f of the diffuse lobe without the transmittances on the way in and out
};

}  // namespace misbench
