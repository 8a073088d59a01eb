// All materials. Light transport, `misbench scene info` and the tests of every material walk this
// list.
#pragma once

#include "renderer/scene/material_model.h"
#include "renderer/scene/materials/conductor.h"
#include "renderer/scene/materials/dielectric.h"
#include "renderer/scene/materials/diffuse.h"
#include "renderer/scene/materials/generic.h"
#include "renderer/scene/materials/plastic.h"

namespace misbench {

template <class... Models>
requires(MaterialModel<Models>&&...) using VariantOfModels = std::variant<Models...>;

using Material =
    VariantOfModels<DiffuseMaterial, RoughDiffuseMaterial, GenericMaterial, ConductorMaterial,
                    RoughConductorMaterial, DielectricMaterial, ThinDielectricMaterial,
                    RoughDielectricMaterial, PlasticMaterial, RoughPlasticMaterial>;

inline Lobes lobes(const Material& material) {
    return std::visit([](const auto& m) { return m.lobes(); }, material);
}

inline BsdfValue evaluate(const Material& material, const Encounter& e, Vec3 wi) {
    return std::visit([&](const auto& m) { return m.evaluate(e, wi); }, material);
}
inline std::optional<BsdfSample> sample(const Material& material, const Encounter& e,
                                        BsdfRandom u) {
    return std::visit([&](const auto& m) { return m.sample(e, u); }, material);
}

}  // namespace misbench
