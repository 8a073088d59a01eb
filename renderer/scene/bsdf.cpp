#include "renderer/scene/bsdf.h"

#include <algorithm>

namespace misbench {
namespace {

// A random number below `part` is stretched back to [0, 1); one above likewise.
float rescale_below(float u, float part) { return std::min(u / part, 0x1.fffffep-1F); }
float rescale_above(float u, float part) {
    return std::min((u - part) / (1 - part), 0x1.fffffep-1F);
}

float number_at(const Scene& scene, const TexturedNumber& number, Vec2 uv) {
    if (number.texture == kNoTexture) return number.value;
    const Rgb color = evaluate(scene.textures()[static_cast<std::size_t>(number.texture)], uv);
    return std::clamp(luminance(color), 0.0F, 1.0F);
}

}  // namespace

template <bool kLayered>
void BasicBsdf<kLayered>::meet(const Scene& scene) {
    const SurfaceMaterial& surface = *point_.material;
    const Side* side = &surface.front;
    if (encounter_.inside && surface.back != SurfaceMaterial::Back::Same) {
        if (surface.back == SurfaceMaterial::Back::Other) side = &*surface.other_back;
        if (surface.back == SurfaceMaterial::Back::Black) side = nullptr;
        encounter_.inside = false;
    }
    parts_.opacity = number_at(scene, surface.opacity, point_.uv);
    if (side == nullptr) return;
    if (!side->other) return meet(scene, side->layer, 1);
    const float weight = number_at(scene, side->other_weight, point_.uv);
    if (weight < 1) meet(scene, side->layer, 1 - weight);
    if (weight > 0) meet(scene, *side->other, weight);
}

template <bool kLayered>
void BasicBsdf<kLayered>::meet(const Scene& scene, const Layer& layer, float weight) {
    const Material* material = &layer.material;
    const auto color_of = [&](std::int32_t texture) {
        return misbench::evaluate(scene.textures()[static_cast<std::size_t>(texture)], point_.uv);
    };
    if (layer.color_texture != kNoTexture || layer.roughness_texture != kNoTexture) {
        std::optional<Material>& copy = parts_.textured[parts_.n];
        copy.emplace(layer.material);
        if (layer.color_texture != kNoTexture) {
            std::visit([&](auto& m) { m.set_color(color_of(layer.color_texture)); }, *copy);
        }
        if (layer.roughness_texture != kNoTexture) {
            std::get<GenericMaterial>(*copy).set_roughness(
                luminance(color_of(layer.roughness_texture)));
        }
        material = &*copy;
    }
    parts_.met[parts_.n++] = {material, weight};
}

template <bool kLayered>
Lobes BasicBsdf<kLayered>::lobes_of_parts() const {
    Lobes all = parts_.opacity < 1 ? kDeltaLobe | kTransmissiveLobe : 0;
    if (parts_.opacity == 0) return all;
    for (std::size_t i = 0; i < parts_.n; ++i) all |= misbench::lobes(*parts_.met[i].material);
    return all;
}

// f and p of a surface that is met with probability `opacity` and is then one of its parts.
template <bool kLayered>
BsdfValue BasicBsdf<kLayered>::evaluate_parts(const Encounter& e, Vec3 wi) const {
    BsdfValue sum;
    for (std::size_t i = 0; i < parts_.n; ++i) {
        const BsdfValue value = misbench::evaluate(*parts_.met[i].material, e, wi);
        const float probability = parts_.opacity * parts_.met[i].weight;
        sum.f_cos += probability * value.f_cos;
        sum.pdf += double{probability} * value.pdf;
    }
    return sum;
}

template <bool kLayered>
std::optional<BsdfSample> BasicBsdf<kLayered>::sample_parts(BsdfRandom u) const {
    // Pass through what is not there.
    if (u.lobe >= parts_.opacity) {
        return BsdfSample{.wi = -encounter_.wo,
                          .weight = kWhite,
                          .pdf = 1 - double{parts_.opacity},
                          .is_delta = true};
    }
    if (parts_.n == 0) return std::nullopt;
    u.lobe = rescale_below(u.lobe, parts_.opacity);

    // Choose a part.
    const Part* part = &parts_.met[0];
    if (parts_.n == 2) {
        if (u.lobe < part->weight) {
            u.lobe = rescale_below(u.lobe, part->weight);
        } else {
            u.lobe = rescale_above(u.lobe, part->weight);
            part = &parts_.met[1];
        }
    }
    std::optional<BsdfSample> sample = misbench::sample(*part->material, encounter_, u);
    if (!sample) return std::nullopt;

    // A delta lobe is its part's own; any other direction could have come from both.
    if (sample->is_delta || parts_.n == 1) {
        sample->pdf *= double{parts_.opacity} * double{part->weight};
        return sample;
    }
    const BsdfValue value = evaluate_parts(encounter_, sample->wi);
    sample->pdf = value.pdf;
    sample->weight = static_cast<float>(1 / value.pdf) * value.f_cos;
    return sample;
}

template class BasicBsdf<true>;

}  // namespace misbench
