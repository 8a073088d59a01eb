// Matte surfaces: Lambert's law, and rough ones after [ON94].
//
// [ON94]  M. Oren, S. K. Nayar, Generalization of Lambert's reflectance model, 1994.
#pragma once

#include "renderer/scene/material_model.h"

namespace misbench {

// f = reflectance / π.
struct DiffuseMaterial {
    static constexpr std::string_view kType = "diffuse";

    Rgb reflectance;

    Lobes lobes() const { return kDiffuseLobe; }
    BsdfValue evaluate(const Encounter& e, Vec3 wi) const;
    std::optional<BsdfSample> sample(const Encounter& e, BsdfRandom u) const;
    void set_color(Rgb color) { reflectance = color; }
};

// [ON94]'s model with shadowing, masking and one interreflection between V-shaped grooves, in its
// functional form.
class RoughDiffuseMaterial {
 public:
    static constexpr std::string_view kType = "rough diffuse";

    struct Parameters {
        Rgb reflectance{0.5F, 0.5F, 0.5F};
        float alpha = 0.2F;  // of the facets' slopes: σ = α / √2 radians
    };
    explicit RoughDiffuseMaterial(const Parameters& parameters);

    Lobes lobes() const { return kDiffuseLobe; }
    BsdfValue evaluate(const Encounter& e, Vec3 wi) const;
    std::optional<BsdfSample> sample(const Encounter& e, BsdfRandom u) const;
    void set_color(Rgb color) { parameters_.reflectance = color; }

 private:
    Parameters parameters_;
    float c1_, c2_, c3_, c4_;  // what σ decides of [ON94]'s coefficients
};

}  // namespace misbench
