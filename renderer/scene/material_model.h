// What a material is: what a surface does with light, in a local frame whose z axis is the shading
// normal on the side of wo.
//
// wo, wi  unit directions away from the surface; wo.z > 0, and wi.z < 0 is transmission
// f       BSDF, 1/sr; delta lobes are never part of f, they are met by sampling only
// η       refractive index on the side of wi over the one on the side of wo
//
// To add a material: write its class in materials/ as MaterialModel (below) asks, and add it to
// Material (material.h).
#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>

#include "renderer/math/vec.h"

namespace misbench {

// What travels along a path from the side of wo: radiance is sought by paths from the camera,
// importance by paths from a light. They differ where light is refracted: f of radiance is that of
// importance over η², f(wo, wi) of radiance is f(wi, wo) of importance.
enum class Transport : std::uint8_t { Radiance, Importance };

// The part of f that refraction owes to what travels.
inline float refraction_scale(Transport transport, float eta) {
    return transport == Transport::Radiance ? 1 / (eta * eta) : 1;
}

// From where a material is looked at.
struct Encounter {
    Vec3 wo;
    bool inside = false;  // wo lies behind the surface, inside of the object that it bounds
    Transport transport = Transport::Radiance;
};

struct BsdfValue {
    Rgb f_cos;       // f(wo, wi) |cos θ_i|
    double pdf = 0;  // of sampling wi given wo, solid angle measure
};

struct BsdfSample {
    Vec3 wi;
    Rgb weight;             // f |cos θ_i| / pdf
    double pdf = 0;         // > 0; solid angle measure, or the probability of a delta lobe
    bool is_delta = false;  // a delta lobe: no other technique can find wi
    float eta = 1;          // η of a transmission, 1 for a reflection
};

// The sample of a direction that is not of a delta lobe; absent where the density is 0.
inline std::optional<BsdfSample> sample_of(Vec3 wi, const BsdfValue& value, float eta = 1) {
    if (!(value.pdf > 0)) return std::nullopt;
    return BsdfSample{.wi = wi,
                      .weight = static_cast<float>(1 / value.pdf) * value.f_cos,
                      .pdf = value.pdf,
                      .eta = eta};
}

// What sampling a direction consumes: which lobe, and where in it. All in [0, 1).
struct BsdfRandom {
    float lobe = 0;
    Vec2 direction;
};

// The lobes of a material, as a set.
using Lobes = unsigned;
inline constexpr Lobes kDiffuseLobe = 1;                           // smooth in wi
inline constexpr Lobes kGlossyLobe = 2;                            // a microfacet lobe
inline constexpr Lobes kSmoothLobes = kDiffuseLobe | kGlossyLobe;  // those that have a density
inline constexpr Lobes kDeltaLobe = 4;                             // reaches single directions
inline constexpr Lobes kTransmissiveLobe = 8;  // some lobe reaches behind the surface

template <class M>
concept MaterialModel = requires(M material, const M& m, const Encounter& e, Vec3 wi, BsdfRandom u,
                                 Rgb color) {
    // As shown by `misbench scene info`.
    { M::kType } -> std::convertible_to<std::string_view>;
    { m.lobes() } -> std::same_as<Lobes>;
    // f and its density over all lobes that are not delta; {} where there is none.
    { m.evaluate(e, wi) } -> std::same_as<BsdfValue>;
    // Absent where the sampled direction carries nothing: the path ends. A delta lobe has the same
    // probability from wi as from wo.
    { m.sample(e, u) } -> std::same_as<std::optional<BsdfSample>>;
    // Replaces what a texture of this material stands for: reflectance or base colour, in [0, 1].
    { material.set_color(color) } -> std::same_as<void>;
};

}  // namespace misbench
