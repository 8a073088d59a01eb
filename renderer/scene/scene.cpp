#include "renderer/scene/scene.h"

#include <limits>

#include "renderer/base/check.h"

namespace misbench {
namespace {

// How far rays must keep from a triangle, from the rounding of all that makes a hit, so that it
// follows each triangle's place and shape. With u = 2⁻²⁴, corners p_i, unit normal n, M_a the
// largest |coordinate| of a corner along axis a, X_a the triangle's extent along it, L the largest
// X_a and A the area:
//
// * The hit point p_0 + (b_1 (p_1 - p_0) + b_2 (p_2 - p_0)) lies within u Σ |n_a| (M_a + 4 X_a) of
//   the plane; leaving it along n rounds once more by u Σ |n_a| M_a.
// * Embree's robust test moves the corners to the ray's origin and crosses their differences. From
//   an origin on the triangle the distance to the plane errs by
//   u (48 X_x X_y X_z / 2A + 4 Σ |n_a| X_a), and a distance of 0 is a hit: L keeps it above 0.
// * From an origin at distance d it errs by u d (8 + 12 (X_x X_y + X_y X_z + X_z X_x) / 2A) more.
//
// The quotients by 2A are large for slivers only. They are cut off where the offset would be
// visible; what remains of self-intersection there is measured in experiments/extremes.
struct Offset {
    double near = 0;
    double slope = 0;
};

constexpr double kMaxSliver = 300;

Offset offset_of(const std::array<Vec3, 3>& corners, const Facet& facet) {
    const double size = 2 * double{facet.area};
    std::array<double, 3> extent{};
    double weighted_extent = 0;
    double weighted_place = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        const auto of = [a](Vec3 p) { return double{a == 0 ? p.x : a == 1 ? p.y : p.z}; };
        const auto [low, high] = std::minmax({of(corners[0]), of(corners[1]), of(corners[2])});
        extent[a] = high - low;
        const double n = std::abs(of(facet.normal));
        weighted_extent += n * extent[a];
        weighted_place += n * std::max(std::abs(low), std::abs(high));
    }
    const auto [x, y, z] = extent;
    const double longest = std::max({x, y, z});
    constexpr double kRounding = 0x1p-24;
    return {.near = kRounding * (2 * weighted_place + 8 * weighted_extent + longest +
                                 48 * std::min(x * y * z / size, kMaxSliver * longest)),
            .slope = kRounding * (8 + 12 * std::min((x * y + y * z + z * x) / size, kMaxSliver))};
}

// Twice the area vector of a triangle, in double: neither small nor large worlds lose it.
std::array<double, 3> area_vector(Vec3 a, Vec3 b, Vec3 c) {
    const std::array<double, 3> e = {double{b.x} - double{a.x}, double{b.y} - double{a.y},
                                     double{b.z} - double{a.z}};
    const std::array<double, 3> f = {double{c.x} - double{a.x}, double{c.y} - double{a.y},
                                     double{c.z} - double{a.z}};
    return {e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]};
}

bool has_texture(const Layer& layer) {
    return layer.color_texture != kNoTexture || layer.roughness_texture != kNoTexture;
}

bool has_texture(const Side& side) {
    return has_texture(side.layer) || (side.other && has_texture(*side.other)) ||
           side.other_weight.texture != kNoTexture;
}

bool is_layered(const SurfaceMaterial& material) {
    return material.front.other.has_value() || material.back != SurfaceMaterial::Back::Same ||
           material.opacity.texture != kNoTexture || material.opacity.value != 1;
}

Lobes lobes_of(const Side& side) {
    return lobes(side.layer.material) | (side.other ? lobes(side.other->material) : 0U);
}

}  // namespace

Lobes lobes(const SurfaceMaterial& material) {
    Lobes all = lobes_of(material.front);
    if (material.other_back) all |= lobes_of(*material.other_back);
    if (material.opacity.texture != kNoTexture || material.opacity.value != 1) {
        all |= kDeltaLobe | kTransmissiveLobe;
    }
    return all;
}

bool has_texture(const SurfaceMaterial& material) {
    return has_texture(material.front) ||
           (material.other_back && has_texture(*material.other_back)) ||
           material.opacity.texture != kNoTexture;
}

Facet facet(const Mesh& mesh, const TriangleIndices& corners) {
    const auto across = area_vector(mesh.positions[corners[0]], mesh.positions[corners[1]],
                                    mesh.positions[corners[2]]);
    const double size =
        std::sqrt(across[0] * across[0] + across[1] * across[1] + across[2] * across[2]);
    return {.normal = {static_cast<float>(across[0] / size), static_cast<float>(across[1] / size),
                       static_cast<float>(across[2] / size)},
            .area = static_cast<float>(0.5 * size)};
}

Scene::Scene(SceneDescription description, int build_threads, const SceneFeatures& assumed)
    : camera_(description.camera),
      film_(description.film),
      features_(assumed),
      materials_(std::move(description.materials)),
      textures_(std::move(description.textures)),
      point_lights_(std::move(description.point_lights)),
      spot_lights_(std::move(description.spot_lights)),
      directional_lights_(std::move(description.directional_lights)) {
    std::size_t n_vertices = 0;
    std::size_t n_triangles = 0;
    for (const Mesh& mesh : description.meshes) {
        n_vertices += mesh.positions.size();
        n_triangles += mesh.triangles.size();
    }
    positions_.reserve(n_vertices + 1);
    triangles_.reserve(n_triangles);
    faces_.reserve(n_triangles);
    quadrics_.reserve(description.quadrics.size());
    for (const Mesh& mesh : description.meshes) add(mesh);
    for (const Quadric& quadric : description.quadrics) add(quadric);
    positions_.emplace_back();
    find_bounds();
    if (description.environment) {
        environment_ = std::make_unique<Environment>(*description.environment);
    }
    add_lights_without_surface();
    find_features();
    accelerator_ = std::make_unique<Accelerator>(positions_, triangles_, quadrics_, build_threads);
}

void Scene::add(const Mesh& mesh) {
    MISBENCH_CHECK(mesh.material < materials_.size());
    const std::size_t first = positions_.size();
    const auto first_vertex = static_cast<std::uint32_t>(first);
    const bool smooth = !mesh.normals.empty();
    const bool textured = !mesh.uvs.empty() && has_texture(materials_[mesh.material]);
    positions_.insert(positions_.end(), mesh.positions.begin(), mesh.positions.end());
    if (smooth) {
        normals_.resize(first);
        normals_.insert(normals_.end(), mesh.normals.begin(), mesh.normals.end());
    }
    if (textured) {
        uvs_.resize(first);
        uvs_.insert(uvs_.end(), mesh.uvs.begin(), mesh.uvs.end());
    }
    const bool emits = !(mesh.emission == Rgb{});
    for (const TriangleIndices& corners : mesh.triangles) {
        const Facet plane = facet(mesh, corners);
        if (!(plane.area > 0)) continue;
        const auto index = static_cast<std::uint32_t>(triangles_.size());
        const Offset offset = offset_of(
            {mesh.positions[corners[0]], mesh.positions[corners[1]], mesh.positions[corners[2]]},
            plane);
        triangles_.push_back(
            {corners[0] + first_vertex, corners[1] + first_vertex, corners[2] + first_vertex});
        faces_.push_back({.normal = plane.normal,
                          .offset = static_cast<float>(offset.near),
                          .offset_slope = static_cast<float>(offset.slope),
                          .light = emits ? static_cast<std::uint32_t>(lights_.size()) : kNoLight,
                          .material = static_cast<std::uint32_t>(mesh.material),
                          .smooth = smooth,
                          .textured = textured});
        if (emits) {
            lights_.push_back({.shape = Light::Shape::Triangle,
                               .index = index,
                               .area = plane.area,
                               .emission = mesh.emission});
        }
    }
}

void Scene::add(const Quadric& quadric) {
    MISBENCH_CHECK(quadric.material < materials_.size());
    const auto index = static_cast<std::uint32_t>(quadrics_.size());
    quadrics_.emplace_back(quadric);
    const bool emits = !(quadric.emission == Rgb{});
    quadric_faces_.push_back(
        {.light = emits ? static_cast<std::uint32_t>(lights_.size()) : kNoLight,
         .material = static_cast<std::uint32_t>(quadric.material)});
    if (emits) {
        lights_.push_back({.shape = Light::Shape::Quadric,
                           .index = index,
                           .area = quadrics_.back().area(),
                           .emission = quadric.emission});
    }
}

void Scene::add_lights_without_surface() {
    const auto add_all = [this](Light::Shape shape, const auto& list, auto emission) {
        for (std::uint32_t i = 0; i < list.size(); ++i) {
            if (emission(list[i]) == Rgb{}) continue;
            lights_.push_back({.shape = shape, .index = i, .emission = emission(list[i])});
        }
    };
    add_all(Light::Shape::Point, point_lights_, [](const PointLight& l) { return l.intensity; });
    add_all(Light::Shape::Spot, spot_lights_, [](const SpotLight& l) { return l.intensity; });
    add_all(Light::Shape::Directional, directional_lights_,
            [](const DirectionalLight& l) { return l.irradiance; });
    if (environment_ && environment_->is_lit()) {
        environment_light_ = static_cast<std::uint32_t>(lights_.size());
        lights_.push_back({.shape = Light::Shape::Environment});
    }
}

void Scene::find_bounds() {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    Vec3 lower{kInfinity, kInfinity, kInfinity};
    Vec3 upper = -lower;
    const auto include = [&](Vec3 low, Vec3 high) {
        lower = min(lower, low);
        upper = max(upper, high);
    };
    for (const TriangleIndices& corners : triangles_) {
        for (const std::uint32_t corner : corners) include(positions_[corner], positions_[corner]);
    }
    for (const QuadricShape& quadric : quadrics_) include(quadric.lower(), quadric.upper());
    if (lower.x > upper.x) return;
    lower_ = lower;
    upper_ = upper;
    center_ = 0.5F * lower + 0.5F * upper;
    radius_ = length(upper - center_);
}

void Scene::find_features() {
    std::vector<bool> is_used(materials_.size(), false);
    for (const Face& face : faces_) is_used[face.material] = true;
    for (const QuadricFace& face : quadric_faces_) is_used[face.material] = true;
    for (std::size_t i = 0; i < materials_.size(); ++i) {
        if (!is_used[i]) continue;
        const Lobes all = lobes(materials_[i]);
        features_.textures |= has_texture(materials_[i]);
        features_.layers |= is_layered(materials_[i]);
        features_.delta_lobes |= (all & kDeltaLobe) != 0;
        features_.transmission |= (all & kTransmissiveLobe) != 0;
    }
    features_.environment |= environment_light_ != kNoLight;
    features_.quadrics |= !quadrics_.empty();
    for (const Light& light : lights_) features_.delta_lights |= light.is_delta();
}

std::size_t Scene::n_geometry_bytes() const {
    const auto n_bytes = [](const auto& list) { return list.size() * sizeof list[0]; };
    return n_bytes(positions_) + n_bytes(normals_) + n_bytes(uvs_) + n_bytes(triangles_) +
           n_bytes(faces_) + n_bytes(quadrics_) + n_bytes(quadric_faces_);
}

SurfacePoint Scene::point_on(std::uint32_t triangle, Vec2 barycentric) const {
    const auto [i0, i1, i2] = triangles_[triangle];
    const Face& face = faces_[triangle];
    const float w = 1 - barycentric.x - barycentric.y;
    const Vec3 a = positions_[i0];
    const Vec3 b = positions_[i1];
    const Vec3 c = positions_[i2];
    SurfacePoint point;
    point.position = a + (barycentric.x * (b - a) + barycentric.y * (c - a));
    point.normal = face.normal;
    point.shading_normal = face.normal;
    if (face.smooth) {
        const Vec3 interpolated =
            w * normals_[i0] + barycentric.x * normals_[i1] + barycentric.y * normals_[i2];
        // Opposite normals cancel somewhere between their corners; there the face's own is used.
        const float size2 = dot(interpolated, interpolated);
        if (size2 > 0) {
            point.shading_normal = (1 / std::sqrt(size2)) * interpolated;
            if (dot(point.shading_normal, face.normal) < 0) point.normal = -face.normal;
        }
    }
    if (face.textured) {
        const Vec2 p = uvs_[i0];
        const Vec2 q = uvs_[i1];
        const Vec2 r = uvs_[i2];
        point.uv = {w * p.x + barycentric.x * q.x + barycentric.y * r.x,
                    w * p.y + barycentric.x * q.y + barycentric.y * r.y};
    }
    point.offset = face.offset;
    point.offset_slope = face.offset_slope;
    point.light = face.light;
    point.material = &materials_[face.material];
    return point;
}

SurfacePoint Scene::point_on_quadric(std::uint32_t quadric, const QuadricShape::Point& at) const {
    SurfacePoint point;
    point.position = at.position;
    point.normal = at.normal;
    point.shading_normal = at.normal;
    point.uv = at.uv;
    // Intersections are computed in double; the ray itself is float.
    constexpr float kRounding = 0x1p-24F;
    point.offset = at.error;
    point.offset_slope = 8 * kRounding;
    point.light = quadric_faces_[quadric].light;
    point.material = &materials_[quadric_faces_[quadric].material];
    return point;
}

std::optional<SurfacePoint> Scene::closest(const Ray& ray) const {
    const std::optional<RayHit> hit = accelerator_->closest(ray);
    if (!hit) return std::nullopt;
    if (hit->is_quadric) {
        return point_on_quadric(hit->primitive, quadrics_[hit->primitive].at(
                                                    ray.origin + hit->distance * ray.direction));
    }
    return point_on(hit->primitive, hit->barycentric);
}

bool Scene::visible(const SurfacePoint& from, const SurfacePoint& to) const {
    const Vec3 edge = to.position - from.position;
    const Vec3 origin = from.leave(edge);
    return !accelerator_->occluded({origin, to.arrive(edge) - origin});
}

bool Scene::visible(const SurfacePoint& from, Vec3 to) const {
    const Vec3 origin = from.leave(to - from.position);
    return !accelerator_->occluded({origin, to - origin});
}

bool Scene::visible_to_infinity(const SurfacePoint& from, Vec3 w) const {
    return !accelerator_->occluded_to_infinity({from.leave(w), w});
}

}  // namespace misbench
