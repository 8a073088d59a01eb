// Materials for the tests of every material: some that are looked at in detail, and a grid over the
// whole range of the parameters. A new material is an overload of rows_of and grid_of here; without
// them nothing compiles that asks for rows.
#pragma once

#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "renderer/base/rng.h"
#include "renderer/scene/material.h"

namespace misbench::test {

struct MaterialRow {
    std::string name;
    Material material;
    // Alphas of the lobe in whose half-vector coordinates directions are binned; 0 bins directions
    // themselves. A narrow lobe is smooth only in its own coordinates.
    Vec2 lobe{};
    float eta = 1;  // of a transmission from outside
    // The largest part of light that the model may send on, and how much more below cos 0.05.
    double max_albedo = 1;
    double grazing_excess = 0;
};

// Walter's fit lies above Smith's masking by as much.
constexpr double kBeckmannAlbedo = 1.0035;

template <class M>
using Type = std::type_identity<M>;
using Rows = std::vector<MaterialRow>;

inline const std::vector<float> kAlphas = {1e-4F, 1e-3F, 0.01F, 0.1F, 0.3F, 1};
inline const std::vector<float> kEtas = {1.0F / 3, 1 / 1.5F, 1, 1.00005F, 1.001F, 1.5F, 3};

inline std::string label(const std::string& name, std::initializer_list<float> values) {
    std::string result = name;
    for (const float v : values) result += ' ' + std::to_string(v);
    return result;
}
inline std::string name_of(Microfacets kind) {
    return kind == Microfacets::Beckmann ? "beckmann" : "ggx";
}
inline double microfacet_albedo(Microfacets kind) {
    return kind == Microfacets::Beckmann ? kBeckmannAlbedo : 1;
}
// A row for each distribution and alpha.
template <class RowOf>
void for_microfacets(const std::vector<float>& alphas, RowOf&& row_of) {
    for (const Microfacets kind : {Microfacets::Beckmann, Microfacets::Ggx}) {
        for (const float alpha : alphas) row_of(kind, alpha);
    }
}

inline Rows rows_of(Type<DiffuseMaterial>) {
    return {{.name = "diffuse", .material = DiffuseMaterial{{1, 1, 1}}}};
}
inline Rows grid_of(Type<DiffuseMaterial> type) { return rows_of(type); }

// The fits of the model, white and very rough, send on a little too much at grazing angles.
inline Rows grid_of(Type<RoughDiffuseMaterial>) {
    Rows rows;
    for (const float reflectance : {0.05F, 1.0F}) {
        for (const float alpha : {0.0F, 0.1F, 0.3F, 0.7F, 1.0F}) {
            const Rgb color = reflectance * kWhite;
            rows.push_back(
                {.name = label("rough_diffuse", {reflectance, alpha}),
                 .material = RoughDiffuseMaterial({.reflectance = color, .alpha = alpha}),
                 .max_albedo = 1.035,
                 .grazing_excess = 0.015});
        }
    }
    return rows;
}
inline Rows rows_of(Type<RoughDiffuseMaterial>) {
    return {{.name = "rough_diffuse", .material = RoughDiffuseMaterial({.alpha = 0.5F})}};
}

// The rough diffuse lobe with retro-reflection does not conserve energy, with the boundary's
// reflection still less: white and rough, it reaches 1.53 at cos 0.05 and 1.65 beyond, and 1.7 and
// 1.84 with an ior of 3. Nor does the blend of metal and glass: both send on their part.
inline MaterialRow generic(const std::string& name, const GenericMaterial::Parameters& p) {
    const double metal = double{p.metallic};
    const double glass = double{p.specular_transmittance};
    const double matte = (1 - metal) * (1 - glass);
    MaterialRow row = {.name = name, .material = GenericMaterial(p), .eta = p.ior};
    if (matte > 0) {
        row.max_albedo = p.ior < 1.5F ? 1.53 : 1.7;
        row.grazing_excess = 0.14;
    }
    if (metal > 0 && glass > 0) row.max_albedo += metal;
    return row;
}
inline MaterialRow generic(const std::string& name, const GenericMaterial::Parameters& p,
                           Vec2 lobe) {
    MaterialRow row = generic(name, p);
    row.lobe = lobe;
    return row;
}
inline Rows rows_of(Type<GenericMaterial>) {
    return {
        generic("metal_rough", {.roughness = 1, .ior = 1.45F, .metallic = 1}),
        generic("metal_glossy", {.roughness = 0.3F, .ior = 1.45F, .metallic = 1}, {0.09F, 0.09F}),
        generic("metal_smooth", {.roughness = 0.1F, .ior = 1.45F, .metallic = 1}, {0.01F, 0.01F}),
        generic("metal_mirror", {.roughness = 0.01F, .ior = 1.45F, .metallic = 1}, {1e-3F, 1e-3F}),
        generic("metal_anisotropic",
                {.roughness = 0.5F, .anisotropic = 0.9F, .ior = 1.45F, .metallic = 1},
                {0.57F, 0.11F}),
        generic("plastic_rough", {.roughness = 1, .ior = 1.45F}),
        generic("plastic_half", {.roughness = 0.5F, .ior = 1.45F}),
        generic("half_metal", {.roughness = 0.625F, .ior = 1.45F, .metallic = 0.55F}),
        generic("high_ior", {.roughness = 0.4F, .ior = 3, .metallic = 0.2F}),
        generic("glass_rough", {.roughness = 0.7F, .ior = 1.45F, .specular_transmittance = 1}),
        generic("glass_anisotropic",
                {.roughness = 0.4F, .anisotropic = 0.9F, .ior = 1.45F, .specular_transmittance = 1},
                {0.36F, 0.07F}),
        generic("glass_smooth", {.roughness = 0.01F, .ior = 1.45F, .specular_transmittance = 1},
                {1e-3F, 1e-3F}),
        generic("glass_default_ior", {.roughness = 0.5F, .specular_transmittance = 1},
                {0.25F, 0.25F}),
        generic(
            "half_glass",
            {.roughness = 0.6F, .ior = 1.45F, .metallic = 0.3F, .specular_transmittance = 0.5F}),
        generic("half_glass_matched",
                {.roughness = 0.6F, .ior = 1, .metallic = 0.3F, .specular_transmittance = 0.5F}),
    };
}
inline Rows grid_of(Type<GenericMaterial>) {
    Rows rows;
    for (const float roughness : {0.0F, 0.1F, 0.3F, 0.6F, 1.0F}) {
        for (const float metallic : {0.0F, 0.5F, 1.0F}) {
            for (const float anisotropic : {0.0F, 0.5F, 1.0F}) {
                for (const float ior : {1.0F, 1.00005F, 1.01F, 1.45F, 3.0F}) {
                    for (const float transmittance : {0.0F, 0.5F, 1.0F}) {
                        rows.push_back(generic(label("generic", {roughness, metallic, anisotropic,
                                                                 ior, transmittance}),
                                               {.roughness = roughness,
                                                .anisotropic = anisotropic,
                                                .ior = ior,
                                                .metallic = metallic,
                                                .specular_transmittance = transmittance}));
                    }
                }
            }
        }
    }
    return rows;
}

inline Rows rows_of(Type<ConductorMaterial>) {
    return {{.name = "mirror", .material = ConductorMaterial({})}};
}
inline Rows grid_of(Type<ConductorMaterial>) {
    Rows rows;
    for (const float eta : {0.0F, 0.2F, 3.0F}) {
        for (const float k : {0.0F, 1.0F, 5.0F}) {
            rows.push_back({.name = label("conductor", {eta, k}),
                            .material = ConductorMaterial({.eta = eta * kWhite, .k = k * kWhite})});
        }
    }
    return rows;
}

inline MaterialRow rough_conductor(Microfacets kind, float alpha, Vec2 lobe = {}) {
    return {.name = label("rough_conductor_" + name_of(kind), {alpha}),
            .material = RoughConductorMaterial({.distribution = kind, .alpha = alpha}),
            .lobe = lobe,
            .max_albedo = microfacet_albedo(kind)};
}
inline Rows grid_of(Type<RoughConductorMaterial>) {
    Rows rows;
    for_microfacets(kAlphas, [&](Microfacets kind, float alpha) {
        rows.push_back(rough_conductor(kind, alpha));
    });
    return rows;
}
inline Rows rows_of(Type<RoughConductorMaterial>) {
    Rows rows;
    for_microfacets({1e-3F, 0.1F, 1}, [&](Microfacets kind, float alpha) {
        rows.push_back(rough_conductor(kind, alpha, {alpha, alpha}));
    });
    return rows;
}

inline Rows rows_of(Type<DielectricMaterial>) {
    return {{.name = "glass", .material = DielectricMaterial({}), .eta = 1.5F}};
}
inline Rows grid_of(Type<DielectricMaterial>) {
    Rows rows;
    for (const float eta : kEtas) {
        rows.push_back({.name = label("dielectric", {eta}),
                        .material = DielectricMaterial({.eta = eta}),
                        .eta = eta});
    }
    return rows;
}

inline Rows rows_of(Type<ThinDielectricMaterial>) {
    return {{.name = "pane", .material = ThinDielectricMaterial({})}};
}
inline Rows grid_of(Type<ThinDielectricMaterial>) {
    Rows rows;
    for (const float eta : kEtas) {
        rows.push_back({.name = label("thin_dielectric", {eta}),
                        .material = ThinDielectricMaterial({.eta = eta})});
    }
    return rows;
}

inline MaterialRow rough_dielectric(float eta, Microfacets kind, float alpha, Vec2 lobe = {}) {
    return {.name = label("rough_dielectric_" + name_of(kind), {eta, alpha}),
            .material = RoughDielectricMaterial({.eta = eta, .distribution = kind, .alpha = alpha}),
            .lobe = lobe,
            .eta = eta,
            .max_albedo = microfacet_albedo(kind)};
}
inline Rows grid_of(Type<RoughDielectricMaterial>) {
    Rows rows;
    for (const float eta : kEtas) {
        for_microfacets(kAlphas, [&](Microfacets kind, float alpha) {
            rows.push_back(rough_dielectric(eta, kind, alpha));
        });
    }
    return rows;
}
inline Rows rows_of(Type<RoughDielectricMaterial>) {
    Rows rows = {rough_dielectric(1, Microfacets::Ggx, 0.1F)};
    for (const float eta : {1 / 1.5F, 1.01F, 1.5F}) {
        for_microfacets({1e-3F, 0.3F}, [&](Microfacets kind, float alpha) {
            rows.push_back(rough_dielectric(eta, kind, alpha, {alpha, alpha}));
        });
    }
    return rows;
}

// The fit of the internal reflectance lets white plastic of a high index send on too much.
inline Rows grid_of(Type<PlasticMaterial>) {
    Rows rows;
    for (const float eta : {1.01F, 1.49F, 2.0F, 3.0F}) {
        rows.push_back({.name = label("plastic", {eta}),
                        .material = PlasticMaterial({.eta = eta, .diffuse_reflectance = kWhite}),
                        .max_albedo = eta > 2 ? 1.19 : 1.003});
    }
    return rows;
}
inline Rows rows_of(Type<PlasticMaterial>) {
    return {{.name = "plastic", .material = PlasticMaterial({})},
            {.name = "plastic_nonlinear", .material = PlasticMaterial({.nonlinear = true})}};
}

inline MaterialRow rough_plastic(float eta, Microfacets kind, float alpha, Rgb color,
                                 Vec2 lobe = {}) {
    return {.name = label("rough_plastic_" + name_of(kind), {eta, alpha}),
            .material = RoughPlasticMaterial(
                {.eta = eta, .diffuse_reflectance = color, .distribution = kind, .alpha = alpha}),
            .lobe = lobe,
            .max_albedo = microfacet_albedo(kind)};
}
inline Rows grid_of(Type<RoughPlasticMaterial>) {
    Rows rows;
    for (const float eta : {1.01F, 1.49F, 3.0F}) {
        for_microfacets({1e-4F, 0.1F, 0.3F, 1}, [&](Microfacets kind, float alpha) {
            rows.push_back(rough_plastic(eta, kind, alpha, kWhite));
        });
    }
    return rows;
}
inline Rows rows_of(Type<RoughPlasticMaterial>) {
    Rows rows;
    for_microfacets({0.03F, 0.5F}, [&](Microfacets kind, float alpha) {
        rows.push_back(rough_plastic(1.49F, kind, alpha, 0.5F * kWhite, {alpha, alpha}));
    });
    return rows;
}

// The rows of all alternatives of Material, by rows_of or grid_of.
template <class RowsOf, class... Models>
Rows rows_of_all(RowsOf&& of, Type<std::variant<Models...>>) {
    Rows all;
    const auto append = [&](Rows rows) {
        // A material without rows is not tested.
        if (rows.empty()) std::abort();
        for (MaterialRow& row : rows) all.push_back(std::move(row));
    };
    (append(of(Type<Models>{})), ...);
    return all;
}
inline const Rows& detailed_rows() {
    static const Rows kRows =
        rows_of_all([](auto type) { return rows_of(type); }, Type<Material>{});
    return kRows;
}
inline const Rows& grid_rows() {
    static const Rows kRows =
        rows_of_all([](auto type) { return grid_of(type); }, Type<Material>{});
    return kRows;
}

// From where a row can be looked at: from inside only what transmits.
inline std::vector<bool> sides_of(const MaterialRow& row) {
    if (lobes(row.material) & kTransmissiveLobe) return {false, true};
    return {false};
}

inline Vec3 direction(float cos_theta, float phi = 0.4F) {
    const float sin_theta = std::sqrt(std::max(0.0F, 1 - cos_theta * cos_theta));
    return {sin_theta * std::cos(phi), sin_theta * std::sin(phi), cos_theta};
}

inline BsdfValue evaluate(const Material& material, const Encounter& e, Vec3 wi) {
    return std::visit([&](const auto& m) { return m.evaluate(e, wi); }, material);
}
inline std::optional<BsdfSample> sample(const Material& material, const Encounter& e, Rng& rng) {
    const float lobe = rng.uniform();
    const float u = rng.uniform();
    const BsdfRandom random{lobe, {u, rng.uniform()}};
    return std::visit([&](const auto& m) { return m.sample(e, random); }, material);
}

// The same two directions with their roles exchanged, and the same transport.
struct Reversed {
    Encounter e;
    Vec3 wi;
};
inline Reversed reversed(const Encounter& e, Vec3 wi) {
    if (wi.z > 0) return {{.wo = wi, .inside = e.inside, .transport = e.transport}, e.wo};
    const auto flipped = [](Vec3 w) { return Vec3{w.x, w.y, -w.z}; };
    return {{.wo = flipped(wi), .inside = !e.inside, .transport = e.transport}, flipped(e.wo)};
}

}  // namespace misbench::test
