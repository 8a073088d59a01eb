// A material at a surface point, seen from one direction: world space in, world space out.
#pragma once

#include "renderer/scene/scene.h"

namespace misbench {

class Bsdf {
 public:
    // wo: unit direction away from the surface, towards where the path came from.
    Bsdf(const SurfacePoint& point, Vec3 wo)
        : point_(point),
          wo_world_(wo),
          frame_(Frame::from_z(dot(point.shading_normal, wo) < 0 ? -point.shading_normal
                                                                 : point.shading_normal)),
          wo_(frame_.to_local(wo)) {}

    BsdfValue evaluate(Vec3 wi) const {
        if (!reflects(wi)) return {};
        const Vec3 local = frame_.to_local(wi);
        return std::visit([&](const auto& m) { return m.evaluate(wo_, local); }, *point_.material);
    }

    // Absent where the sampled direction carries nothing: the path ends.
    std::optional<BsdfSample> sample(BsdfRandom u) const {
        auto sample = std::visit([&](const auto& m) { return m.sample(wo_, u); }, *point_.material);
        if (!sample) return std::nullopt;
        sample->wi = frame_.to_world(sample->wi);
        if (!reflects(sample->wi)) return std::nullopt;
        return sample;
    }

 private:
    // Interpolated normals must not let light through: both directions on one side of the face.
    bool reflects(Vec3 wi) const {
        return dot(point_.normal, wi) * dot(point_.normal, wo_world_) > 0;
    }

    const SurfacePoint& point_;
    Vec3 wo_world_;
    Frame frame_;
    Vec3 wo_;
};

}  // namespace misbench
