// A scene that can be rendered: immutable, shared by all threads.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "renderer/embree/accelerator.h"
#include "renderer/scene/description.h"
#include "renderer/scene/light_sampler.h"

namespace misbench {

inline constexpr std::uint32_t kNoLight = ~0U;

// A point on a surface, with what a path needs to go on from it.
struct SurfacePoint {
    Vec3 position;
    Vec3 normal;          // geometric, unit, on the front (counter-clockwise) side
    Vec3 shading_normal;  // unit, as the scene gives it: not turned towards the viewer
    float offset = 0;     // how far along the normal a new ray must start to leave the surface
    std::uint32_t light = kNoLight;  // index into Scene::lights()
    const Material* material = nullptr;

    // Where a ray or segment towards direction w may start.
    Vec3 leave(Vec3 w) const { return position + (dot(normal, w) < 0 ? -offset : offset) * normal; }
};

class Scene {
 public:
    // Triangles without area are left out: no ray meets them, and no point on them has a density.
    Scene(SceneDescription description, int build_threads);

    const PerspectiveCamera& camera() const { return camera_; }
    std::span<const EmissiveTriangle> lights() const { return lights_; }
    std::span<const Vec3> vertices() const { return positions_; }  // one more than are used
    std::span<const TriangleIndices> triangles() const { return triangles_; }
    const Accelerator& accelerator() const { return *accelerator_; }

    std::optional<SurfacePoint> closest(const Ray& ray) const;
    // Whether nothing lies between two surface points.
    bool visible(const SurfacePoint& from, const SurfacePoint& to) const;

    // A point of a triangle, by barycentric coordinates of its second and third corner.
    SurfacePoint point_on(std::uint32_t triangle, Vec2 barycentric) const;
    // The radiance that a surface point emits into direction w: one-sided, by the shading normal.
    Rgb emitted(const SurfacePoint& point, Vec3 w) const {
        if (point.light == kNoLight || dot(point.shading_normal, w) <= 0) return {};
        return lights_[point.light].radiance;
    }

 private:
    // What a hit needs of its triangle beside the corners, together in half a cache line.
    struct Face {
        Vec3 normal;   // unit
        float offset;  // SurfacePoint::offset
        std::uint32_t light;
        std::uint32_t material;
        bool smooth;  // normals_ has this triangle's corners
    };

    void add(const Mesh& mesh);

    PerspectiveCamera camera_;
    std::vector<Vec3> positions_;  // of all meshes, with one element to spare for Embree
    std::vector<Vec3> normals_;    // parallel to positions_ where a mesh is smooth
    std::vector<TriangleIndices> triangles_;
    std::vector<Face> faces_;  // parallel to triangles_
    std::vector<Material> materials_;
    std::vector<EmissiveTriangle> lights_;
    std::unique_ptr<Accelerator> accelerator_;
};

// The conversion of a density from area measure at `to` to solid angle measure at `from`:
// dω = |cos θ_to| / d² dA. Infinite where the surface is seen edge-on.
inline double area_to_solid_angle(double pdf_area, const SurfacePoint& from,
                                  const SurfacePoint& to) {
    const Vec3 edge = to.position - from.position;
    const float d2 = dot(edge, edge);
    return pdf_area * double{d2} * double{std::sqrt(d2)} / double{std::abs(dot(to.normal, edge))};
}

}  // namespace misbench
