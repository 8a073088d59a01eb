// Materials: what a surface does with light, in a local frame whose z axis is the shading normal on
// the side of wo.
//
// wo, wi  unit directions away from the surface, towards the camera and the light; wo.z > 0
// f       BSDF, 1/sr
#pragma once

#include <optional>
#include <variant>

#include "renderer/math/vec.h"

namespace misbench {

struct BsdfValue {
    Rgb f_cos;       // f(wo, wi) |cos θ_i|
    double pdf = 0;  // of sampling wi given wo, solid angle measure
};

struct BsdfSample {
    Vec3 wi;
    Rgb weight;      // f |cos θ_i| / pdf
    double pdf = 0;  // solid angle measure, > 0
};

// What sampling a direction consumes: which lobe, and where in it.
struct BsdfRandom {
    float lobe = 0;
    Vec2 direction;
};

// Lambert: f = reflectance / π.
struct DiffuseMaterial {
    Rgb reflectance;

    BsdfValue evaluate(Vec3 wo, Vec3 wi) const;
    std::optional<BsdfSample> sample(Vec3 wo, BsdfRandom u) const;
};

// The reflective part of SeeSharp's generic material: a rough diffuse lobe with retro-reflection
// after [Bur15] and a GGX lobe whose Fresnel term blends a dielectric with Schlick's metal.
//
// [Bur15]  B. Burley, Extending the Disney BRDF to a BSDF with integrated subsurface scattering.
// [Hei14]  E. Heitz, Understanding the masking-shadowing function in microfacet-based BRDFs.
// [DB23]   J. Dupuy, A. Benyoub, Sampling visible GGX normals with spherical caps.
class GenericMaterial {
 public:
    struct Parameters {
        Rgb base_color{1, 1, 1};
        float roughness = 0.5F;
        float anisotropic = 0;
        float ior = 1.01F;
        float metallic = 0;
        float specular_tint = 0;
    };
    explicit GenericMaterial(const Parameters& parameters);

    BsdfValue evaluate(Vec3 wo, Vec3 wi) const;
    std::optional<BsdfSample> sample(Vec3 wo, BsdfRandom u) const;

 private:
    float diffuse_probability(Vec3 wo) const;
    Rgb diffuse(Vec3 wo, Vec3 wi, Vec3 half) const;
    Rgb specular_tinted_fresnel(float cos_half) const;

    Rgb base_color_;
    Rgb tint_;
    Rgb specular_at_normal_;  // R0
    float roughness_;
    float alpha_x_;
    float alpha_y_;
    float ior_;
    float metallic_;
    float diffuse_weight_;
};

using Material = std::variant<DiffuseMaterial, GenericMaterial>;

}  // namespace misbench
