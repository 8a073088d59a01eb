// SeeSharp's generic material: a rough diffuse lobe with retro-reflection after [Bur15], a GGX lobe
// whose Fresnel term blends a dielectric with Schlick's metal, and a GGX lobe of refraction.
//
// [Bur15]  B. Burley, Extending the Disney BRDF to a BSDF with integrated subsurface scattering.
// [WMLT07] B. Walter et al., Microfacet models for refraction through rough surfaces, 2007.
#pragma once

#include "renderer/scene/material_model.h"

namespace misbench {

class GenericMaterial {
 public:
    static constexpr std::string_view kType = "generic";

    struct Parameters {
        Rgb base_color{1, 1, 1};
        float roughness = 0.5F;
        float anisotropic = 0;
        float ior = 1.01F;
        float metallic = 0;
        float specular_tint = 0;
        // The part of light that the boundary does not reflect and that is refracted, tinted by the
        // base colour. An ior within 1e-4 of one lets it pass straight on, a delta lobe.
        float specular_transmittance = 0;
    };
    explicit GenericMaterial(const Parameters& parameters);

    Lobes lobes() const;
    BsdfValue evaluate(const Encounter& e, Vec3 wi) const;
    std::optional<BsdfSample> sample(const Encounter& e, BsdfRandom u) const;
    void set_color(Rgb color);
    void set_roughness(float roughness);

 private:
    void prepare();  // all below parameters_, from them
    float diffuse_probability(Vec3 wo) const;
    Rgb diffuse(Vec3 wo, Vec3 wi, Vec3 half) const;
    float eta_across(const Encounter& e) const;
    Rgb specular_tinted_fresnel(float cos_half, float eta) const;
    float transmission_probability(Vec3 wo, float cos_half, float eta) const;
    BsdfValue evaluate_reflection(const Encounter& e, Vec3 wi) const;
    BsdfValue evaluate_refraction(const Encounter& e, Vec3 wi) const;
    BsdfSample sample_straight(Vec3 wo, float probability) const;

    Parameters parameters_;
    Rgb tint_;
    Rgb specular_at_normal_;  // R0
    float alpha_x_ = 0;
    float alpha_y_ = 0;
    float diffuse_weight_ = 0;
    bool is_straight_ = false;  // transmission is a delta lobe
};

}  // namespace misbench
