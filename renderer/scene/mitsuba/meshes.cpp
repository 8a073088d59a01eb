#include "renderer/scene/mitsuba/meshes.h"

#include <cmath>

#include "renderer/scene/mitsuba/transform.h"

namespace misbench::mitsuba {
namespace {

void reverse_winding(Mesh& mesh) {
    for (TriangleIndices& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
}

// Unit length, or 0 where there is no direction.
Vec3 unit_or_zero(Vec3 n) {
    const float size = length(n);
    return std::isfinite(size) && size > 0 ? (1 / size) * n : Vec3{};
}

// The faces' normals around each vertex, weighted by the angle that a face has there.  [TW98]
void add_smooth_normals(Mesh& mesh) {
    mesh.normals.assign(mesh.positions.size(), {});
    for (const TriangleIndices& triangle : mesh.triangles) {
        const auto corner = [&](std::size_t i) { return mesh.positions[triangle[i % 3]]; };
        const Vec3 normal = unit_or_zero(cross(corner(1) - corner(0), corner(2) - corner(0)));
        if (normal == Vec3{}) continue;
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3 a = normalized(corner(i + 1) - corner(i));
            const Vec3 b = normalized(corner(i + 2) - corner(i));
            const float angle = std::atan2(length(cross(a, b)), dot(a, b));
            Vec3& sum = mesh.normals[triangle[i]];
            sum = sum + angle * normal;
        }
    }
    for (Vec3& n : mesh.normals) n = unit_or_zero(n);
}

}  // namespace

Mesh rectangle() {
    Mesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.normals.assign(4, {0, 0, 1});
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

Mesh cube() {
    // Of each face the normal, and its first two corners' way: from the first to the second, and
    // from the second to the third.
    struct Side {
        Vec3 normal, along, across;
    };
    Mesh mesh;
    for (const Side& side :
         {Side{{0, -1, 0}, {0, 0, 1}, {-1, 0, 0}}, Side{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}},
          Side{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, Side{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}},
          Side{{-1, 0, 0}, {0, 1, 0}, {0, 0, -1}}, Side{{0, 0, -1}, {0, -1, 0}, {-1, 0, 0}}}) {
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        const Vec3 n = side.normal;
        mesh.positions.insert(mesh.positions.end(),
                              {n - side.along - side.across, n + side.along - side.across,
                               n + side.along + side.across, n - side.along + side.across});
        mesh.uvs.insert(mesh.uvs.end(), {{0, 1}, {1, 1}, {1, 0}, {0, 0}});
        mesh.normals.insert(mesh.normals.end(), 4, n);
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first + 3, first, first + 2});
    }
    return mesh;
}

void map_mesh(Mesh& mesh, const Transform& to_world) {
    for (Vec3& p : mesh.positions) p = to_world.point(p);
    for (Vec3& n : mesh.normals) n = map_normal(to_world, n);
    if (determinant(to_world) < 0) reverse_winding(mesh);
}

void place_mesh(Mesh& mesh, const Placement& placement) {
    if (placement.face_normals) mesh.normals.clear();
    const bool has_normals = !mesh.normals.empty();
    map_mesh(mesh, placement.to_world);
    // Mitsuba maps the corners and then takes the normals of a mesh that has none of its own from
    // them: such a mesh is turned inside out by a mirroring map, one with normals is not.
    if (!has_normals && determinant(placement.to_world) < 0) reverse_winding(mesh);
    if (placement.flip_normals) {
        reverse_winding(mesh);
        for (Vec3& n : mesh.normals) n = -n;
    }
    if (!has_normals && !placement.face_normals) add_smooth_normals(mesh);
}

}  // namespace misbench::mitsuba
