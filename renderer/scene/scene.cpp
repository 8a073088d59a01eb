#include "renderer/scene/scene.h"

#include <limits>

#include "renderer/base/check.h"

namespace misbench {
namespace {

// The hit point is a sum of three products of corners with weights that sum to one, so its error
// is a few roundings of the largest coordinate that took part; Embree's own arithmetic adds as
// many again relative to the ray's origin, which lies on such a surface too.
constexpr float kRoundings = 32 * std::numeric_limits<float>::epsilon();

}  // namespace

Scene::Scene(SceneDescription description, int build_threads)
    : camera_(description.camera), materials_(std::move(description.materials)) {
    std::size_t n_vertices = 0;
    std::size_t n_triangles = 0;
    for (const Mesh& mesh : description.meshes) {
        n_vertices += mesh.positions.size();
        n_triangles += mesh.triangles.size();
    }
    positions_.reserve(n_vertices + 1);
    normals_.reserve(n_vertices);
    triangles_.reserve(n_triangles);
    faces_.reserve(n_triangles);
    for (const Mesh& mesh : description.meshes) add(mesh);
    positions_.emplace_back();
    accelerator_ = std::make_unique<Accelerator>(positions_, triangles_, build_threads);
}

void Scene::add(const Mesh& mesh) {
    MISBENCH_CHECK(mesh.material < materials_.size());
    const auto first_vertex = static_cast<std::uint32_t>(positions_.size());
    positions_.insert(positions_.end(), mesh.positions.begin(), mesh.positions.end());
    normals_.insert(normals_.end(), mesh.normals.begin(), mesh.normals.end());
    normals_.resize(positions_.size());
    for (const TriangleIndices& corners : mesh.triangles) {
        const Vec3 a = mesh.positions[corners[0]];
        const Vec3 b = mesh.positions[corners[1]];
        const Vec3 c = mesh.positions[corners[2]];
        const Vec3 across = cross(b - a, c - a);
        const float area = 0.5F * length(across);
        if (!(area > 0)) continue;
        const auto index = static_cast<std::uint32_t>(triangles_.size());
        const bool emits = !(mesh.emission == Rgb{});
        triangles_.push_back(
            {corners[0] + first_vertex, corners[1] + first_vertex, corners[2] + first_vertex});
        faces_.push_back({.normal = normalized(across),
                          .offset = kRoundings * std::max({max_abs(a), max_abs(b), max_abs(c)}),
                          .light = emits ? static_cast<std::uint32_t>(lights_.size()) : kNoLight,
                          .material = static_cast<std::uint32_t>(mesh.material),
                          .smooth = !mesh.normals.empty()});
        if (emits) lights_.push_back({index, area, mesh.emission});
    }
}

SurfacePoint Scene::point_on(std::uint32_t triangle, Vec2 barycentric) const {
    const auto [i0, i1, i2] = triangles_[triangle];
    const Face& face = faces_[triangle];
    const float w = 1 - barycentric.x - barycentric.y;
    SurfacePoint point;
    point.position =
        w * positions_[i0] + barycentric.x * positions_[i1] + barycentric.y * positions_[i2];
    point.normal = face.normal;
    point.shading_normal = face.normal;
    if (face.smooth) {
        const Vec3 interpolated =
            w * normals_[i0] + barycentric.x * normals_[i1] + barycentric.y * normals_[i2];
        // Opposite normals cancel somewhere between their corners; there the face's own is used.
        const float size2 = dot(interpolated, interpolated);
        if (size2 > 0) point.shading_normal = (1 / std::sqrt(size2)) * interpolated;
    }
    point.offset = face.offset;
    point.light = face.light;
    point.material = &materials_[face.material];
    return point;
}

std::optional<SurfacePoint> Scene::closest(const Ray& ray) const {
    const std::optional<RayHit> hit = accelerator_->closest(ray);
    if (!hit) return std::nullopt;
    return point_on(hit->triangle, hit->barycentric);
}

bool Scene::visible(const SurfacePoint& from, const SurfacePoint& to) const {
    const Vec3 edge = to.position - from.position;
    const Vec3 origin = from.leave(edge);
    return !accelerator_->occluded({origin, to.leave(-edge) - origin});
}

}  // namespace misbench
