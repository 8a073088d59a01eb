// A scene that can be rendered: immutable, shared by all threads.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "renderer/embree/accelerator.h"
#include "renderer/scene/description.h"
#include "renderer/scene/light.h"
#include "renderer/scene/quadric.h"

namespace misbench {

inline constexpr std::uint32_t kNoLight = ~0U;

// A point on a surface, with what a path needs to go on from it.
struct SurfacePoint {
    Vec3 position;
    Vec3 normal;          // geometric, unit, on the side of the shading normal
    Vec3 shading_normal;  // unit, as the scene gives it: not turned towards the viewer
    Vec2 uv;              // of textured surfaces; else (0, 0)
    // How far along the normal a new ray must start to leave the surface, and what a segment of
    // length d that ends here must keep away from it beyond that: d · offset_slope.
    float offset = 0;
    float offset_slope = 0;
    std::uint32_t light = kNoLight;  // index into Scene::lights()
    const SurfaceMaterial* material = nullptr;

    // Where a ray or segment towards direction w may start.
    Vec3 leave(Vec3 w) const { return position + (dot(normal, w) < 0 ? -offset : offset) * normal; }
    // Where a segment along `edge` that comes here may end: before the surface, however short it
    // is.
    Vec3 arrive(Vec3 edge) const {
        const float height = dot(normal, edge);
        const float back = std::min(offset + offset_slope * length(edge), 0.5F * std::abs(height));
        return position + (height > 0 ? -back : back) * normal;
    }
};

// What a scene asks of the light transport beyond triangles of one material a side.
struct SceneFeatures {
    bool textures = false;
    bool layers = false;        // blends, opacity, backs that differ from the fronts
    bool delta_lobes = false;   // directions that only BSDF sampling finds
    bool transmission = false;  // light behind surfaces
    bool environment = false;   // rays that escape bring light
    bool delta_lights = false;  // lights that only next event estimation finds
    bool quadrics = false;      // curved surfaces
    bool operator==(const SceneFeatures&) const = default;
};
inline constexpr SceneFeatures kAllFeatures{true, true, true, true, true, true, true};

// Of all its layers and sides; opacity below 1 is a delta lobe that goes straight on.
Lobes lobes(const SurfaceMaterial& material);
bool has_texture(const SurfaceMaterial& material);

// A triangle without its shading: the normal by its winding, unit, and the area. Where that is 0
// the triangle is degenerate, and the normal means nothing.
struct Facet {
    Vec3 normal;
    float area = 0;
};
Facet facet(const Mesh& mesh, const TriangleIndices& corners);

class Scene {
 public:
    // Triangles without area are left out: no ray meets them, and no point on them has a density.
    // features() has those of `assumed` too, so that tests and benchmarks can compare the render
    // loops of a scene with more general ones.
    Scene(SceneDescription description, int build_threads, const SceneFeatures& assumed = {});

    const PerspectiveCamera& camera() const { return camera_; }
    const FilmDefaults& film() const { return film_; }
    const SceneFeatures& features() const { return features_; }
    std::span<const Light> lights() const { return lights_; }
    std::span<const Vec3> vertices() const { return positions_; }  // one more than are used
    std::span<const TriangleIndices> triangles() const { return triangles_; }
    std::span<const QuadricShape> quadrics() const { return quadrics_; }
    std::span<const SurfaceMaterial> materials() const { return materials_; }
    std::span<const Texture> textures() const { return textures_; }
    const Environment* environment() const { return environment_.get(); }  // null: none
    const PointLight& point_light(const Light& light) const { return point_lights_[light.index]; }
    const SpotLight& spot_light(const Light& light) const { return spot_lights_[light.index]; }
    const DirectionalLight& directional_light(const Light& light) const {
        return directional_lights_[light.index];
    }
    std::uint32_t environment_light() const { return environment_light_; }  // or kNoLight
    const Accelerator& accelerator() const { return *accelerator_; }
    std::size_t n_geometry_bytes() const;  // in memory, without the BVH

    // A sphere around all surfaces.
    Vec3 center() const { return center_; }
    float radius() const { return radius_; }
    Vec3 lower() const { return lower_; }  // and a box; (0, 0, 0) both where there is no surface
    Vec3 upper() const { return upper_; }

    std::optional<SurfacePoint> closest(const Ray& ray) const;
    // Whether nothing lies between two surface points; between a surface point and a point in
    // space; on the whole ray from a surface point.
    bool visible(const SurfacePoint& from, const SurfacePoint& to) const;
    bool visible(const SurfacePoint& from, Vec3 to) const;
    bool visible_to_infinity(const SurfacePoint& from, Vec3 w) const;

    // A point of a triangle, by barycentric coordinates of its second and third corner.
    SurfacePoint point_on(std::uint32_t triangle, Vec2 barycentric) const;
    SurfacePoint point_on_quadric(std::uint32_t quadric, const QuadricShape::Point& point) const;
    // The radiance that a surface point emits into direction w: one-sided, by the shading normal.
    Rgb emitted(const SurfacePoint& point, Vec3 w) const {
        if (point.light == kNoLight || dot(point.shading_normal, w) <= 0 ||
            dot(point.normal, w) <= 0) {
            return {};
        }
        return lights_[point.light].emission;
    }
    // The radiance that arrives from far outside, from direction w.
    Rgb background(Vec3 w) const {
        return environment_light_ == kNoLight ? Rgb{} : environment_->radiance(w);
    }

 private:
    // What a hit needs of its triangle beside the corners, together in half a cache line.
    struct Face {
        Vec3 normal;   // unit
        float offset;  // as in SurfacePoint
        float offset_slope;
        std::uint32_t light;
        std::uint32_t material;
        bool smooth;    // normals_ has this triangle's corners
        bool textured;  // uvs_ has this triangle's corners
    };
    struct QuadricFace {
        std::uint32_t light;
        std::uint32_t material;
    };

    void add(const Mesh& mesh);
    void add(const Quadric& quadric);
    void add_lights_without_surface();
    void find_bounds();
    void find_features();

    PerspectiveCamera camera_;
    FilmDefaults film_;
    SceneFeatures features_;
    std::vector<Vec3> positions_;  // of all meshes, with one element to spare for Embree
    std::vector<Vec3> normals_;    // parallel to positions_, as far as the last smooth mesh
    std::vector<Vec2> uvs_;        // parallel to positions_, as far as the last textured mesh
    std::vector<TriangleIndices> triangles_;
    std::vector<Face> faces_;  // parallel to triangles_
    std::vector<QuadricShape> quadrics_;
    std::vector<QuadricFace> quadric_faces_;  // parallel to quadrics_
    std::vector<SurfaceMaterial> materials_;
    std::vector<Texture> textures_;
    std::vector<Light> lights_;
    std::vector<PointLight> point_lights_;
    std::vector<SpotLight> spot_lights_;
    std::vector<DirectionalLight> directional_lights_;
    std::unique_ptr<const Environment> environment_;
    std::uint32_t environment_light_ = kNoLight;
    Vec3 lower_;
    Vec3 upper_;
    Vec3 center_;
    float radius_ = 0;
    std::unique_ptr<Accelerator> accelerator_;
};

// The conversion of a density from area measure at `to` to solid angle measure at `from`:
// dω = |cos θ_to| / d² dA. Infinite where the surface is seen edge-on.
inline double area_to_solid_angle(double pdf_area, Vec3 from, const SurfacePoint& to) {
    const Vec3 edge = to.position - from;
    const double d2 = squared_length(edge);
    return pdf_area * d2 * std::sqrt(d2) / std::abs(double{dot(to.normal, edge)});
}

// And back: the density at `to` of a direction from `from`.
inline double solid_angle_to_area(double pdf_solid_angle, Vec3 from, const SurfacePoint& to) {
    const Vec3 edge = to.position - from;
    const double d2 = squared_length(edge);
    return pdf_solid_angle * std::abs(double{dot(to.normal, edge)}) / (d2 * std::sqrt(d2));
}

}  // namespace misbench
