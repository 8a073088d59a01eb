// The scattering of light at one surface point seen from one direction: world space in, world space
// out. Puts together what a SurfaceMaterial says: its side, textures, blend and opacity.
//
// [Vea97]  E. Veach, Robust Monte Carlo Methods for Light Transport Simulation, 1997.
#pragma once

#include <array>

#include "renderer/scene/scene.h"

namespace misbench {

// kLayered: surfaces may have textures and layers (SceneFeatures); without, every surface is one
// material on both sides.
template <bool kLayered>
class BasicBsdf {
 public:
    // wo: unit direction away from the surface, towards where the path came from. The scene and the
    // point must outlive this object.
    BasicBsdf(const Scene& scene, const SurfacePoint& point, Vec3 wo,
              Transport transport = Transport::Radiance)
        : point_(point),
          cos_geometric_(dot(point.normal, wo)),
          frame_(Frame::from_z(dot(point.shading_normal, wo) < 0 ? -point.shading_normal
                                                                 : point.shading_normal)),
          encounter_{
              .wo = frame_.to_local(wo), .inside = cos_geometric_ < 0, .transport = transport} {
        if constexpr (kLayered) meet(scene);
    }
    BasicBsdf(const BasicBsdf&) = delete;
    BasicBsdf& operator=(const BasicBsdf&) = delete;

    // Of what is met here. Without smooth ones evaluate() is 0 for all directions.
    Lobes lobes() const {
        if constexpr (kLayered) {
            return lobes_of_parts();
        } else {
            return misbench::lobes(point_.material->front.layer.material);
        }
    }

    // Without delta lobes.
    BsdfValue evaluate(Vec3 wi) const {
        const Vec3 local = frame_.to_local(wi);
        if (!is_consistent(local, wi)) return {};
        BsdfValue value = evaluate_local(encounter_, local);
        value.f_cos = correction(local, wi) * value.f_cos;
        return value;
    }

    // Absent where the sampled direction carries nothing: the path ends.
    std::optional<BsdfSample> sample(BsdfRandom u) const {
        std::optional<BsdfSample> sample = sample_local(u);
        if (!sample) return std::nullopt;
        const Vec3 local = sample->wi;
        sample->wi = frame_.to_world(local);
        if (!is_consistent(local, sample->wi)) return std::nullopt;
        sample->weight = correction(local, sample->wi) * sample->weight;
        return sample;
    }

    // The density with which a path that comes from wi would go on to wo; solid angle measure,
    // without delta lobes.
    double reverse_pdf(Vec3 wi) const {
        const Vec3 local = frame_.to_local(wi);
        if (!is_consistent(local, wi)) return 0;
        Encounter e = encounter_;
        e.wo = local;
        Vec3 back = encounter_.wo;
        if (local.z < 0) {
            // From behind the surface the frame is turned.
            e.wo.z = -e.wo.z;
            back.z = -back.z;
            e.inside = !e.inside;
        }
        return evaluate_local(e, back).pdf;
    }

 private:
    // A material at this point, and the probability that it is met.
    struct Part {
        const Material* material = nullptr;
        float weight = 1;
    };

    // Interpolated normals must not let light through: what is reflection for them must be
    // reflection for the face, and transmission transmission. Nothing goes along the surface.
    bool is_consistent(Vec3 local, Vec3 wi) const {
        const float product = dot(point_.normal, wi) * cos_geometric_;
        return encounter_.wo.z > 0 && product * local.z > 0;
    }
    // Shading normals make light paths and camera paths disagree; what light carries is f |cos θ_i|
    // times |wo·n_s| |wi·n_g| / (|wo·n_g| |wi·n_s|).                              [Vea97 §5.3]
    float correction(Vec3 local, Vec3 wi) const {
        if (encounter_.transport == Transport::Radiance) return 1;
        return std::abs(encounter_.wo.z * dot(point_.normal, wi) / (cos_geometric_ * local.z));
    }

    BsdfValue evaluate_local(const Encounter& e, Vec3 wi) const {
        if constexpr (kLayered) {
            return evaluate_parts(e, wi);
        } else {
            return misbench::evaluate(point_.material->front.layer.material, e, wi);
        }
    }
    std::optional<BsdfSample> sample_local(BsdfRandom u) const {
        if constexpr (kLayered) {
            return sample_parts(u);
        } else {
            return misbench::sample(point_.material->front.layer.material, encounter_, u);
        }
    }
    BsdfValue evaluate_parts(const Encounter& e, Vec3 wi) const;
    std::optional<BsdfSample> sample_parts(BsdfRandom u) const;
    Lobes lobes_of_parts() const;
    void meet(const Scene& scene);
    void meet(const Scene& scene, const Layer& layer, float weight);

    const SurfacePoint& point_;
    float cos_geometric_;
    Frame frame_;  // z: the shading normal on the side of wo
    Encounter encounter_;
    struct Parts {
        float opacity = 1;
        std::size_t n = 0;
        std::array<Part, 2> met;
        std::array<std::optional<Material>, 2> textured;  // met ones with textures applied
    };
    struct None {};
    [[no_unique_address]] std::conditional_t<kLayered, Parts, None> parts_;
};

extern template class BasicBsdf<true>;

using Bsdf = BasicBsdf<true>;

}  // namespace misbench
