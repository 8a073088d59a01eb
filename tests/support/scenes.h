// Small scenes with a known answer, made in memory.
#pragma once

#include "renderer/scene/scene.h"

namespace misbench::test {

// A quadrilateral of two triangles, counter-clockwise seen from its front.
inline Mesh quad(Vec3 a, Vec3 b, Vec3 c, Vec3 d, std::size_t material, Rgb emission = {}) {
    Mesh mesh;
    mesh.positions = {a, b, c, d};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.material = material;
    mesh.emission = emission;
    return mesh;
}

// A surface of one material, on both sides.
inline SurfaceMaterial surface(const Material& material) {
    return {.name = "", .front = {.layer = {.material = material}}};
}

// The box [-1, 1]³ seen from inside: all six faces look inwards, have the material and emit.
inline SceneDescription furnace(const Material& material, Rgb emission) {
    SceneDescription scene;
    scene.materials = {surface(material)};
    const auto add = [&](Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
        scene.meshes.push_back(quad(a, b, c, d, 0, emission));
    };
    add({-1, -1, 1}, {1, -1, 1}, {1, -1, -1}, {-1, -1, -1});  // floor, looks up
    add({-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1});      // ceiling, looks down
    add({-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1});  // back, looks to +z
    add({-1, 1, 1}, {1, 1, 1}, {1, -1, 1}, {-1, -1, 1});      // front, looks to -z
    add({-1, -1, 1}, {-1, -1, -1}, {-1, 1, -1}, {-1, 1, 1});  // left, looks to +x
    add({1, 1, 1}, {1, 1, -1}, {1, -1, -1}, {1, -1, 1});      // right, looks to -x
    scene.camera.fov_degrees = 60;
    return scene;
}

inline constexpr float kLampHeight = 1.5F;
inline constexpr float kLampHalfWidth = 0.8F;
inline constexpr float kLampHalfDepth = 0.5F;

// A large Lambert floor at y = 0 under a rectangular lamp that looks down (or up, if turned), and
// a camera that looks at the point below the lamp's centre through a needle's eye.
inline SceneDescription floor_under_lamp(Rgb reflectance, Rgb radiance, bool turned = false) {
    SceneDescription scene;
    scene.materials = {surface(DiffuseMaterial{reflectance}), surface(DiffuseMaterial{})};
    scene.meshes.push_back(quad({-50, 0, 50}, {50, 0, 50}, {50, 0, -50}, {-50, 0, -50}, 0));
    const float w = kLampHalfWidth;
    const float d = turned ? -kLampHalfDepth : kLampHalfDepth;
    const float h = kLampHeight;
    scene.meshes.push_back(quad({-w, h, -d}, {w, h, -d}, {w, h, d}, {-w, h, d}, 1, radiance));
    // At (0, 1, 4), looking along (0, -1, -4).
    const Vec3 back = normalized({0, 1, 4});
    const Vec3 up = cross(back, {1, 0, 0});
    scene.camera.to_world.rows = {
        {{1, up.x, back.x, 0}, {0, up.y, back.y, 1}, {0, up.z, back.z, 4}}};
    scene.camera.fov_degrees = 0.01F;
    return scene;
}

// The box [-1, 1]³ without its front, seen through that: white, but red on the left and green on
// the right (materials 0 to 2). There is no light in it.
inline SceneDescription open_box() {
    SceneDescription scene;
    scene.materials = {surface(DiffuseMaterial{{0.7F, 0.7F, 0.7F}}),
                       surface(DiffuseMaterial{{0.6F, 0.1F, 0.1F}}),
                       surface(DiffuseMaterial{{0.1F, 0.5F, 0.1F}})};
    const auto add = [&](Vec3 a, Vec3 b, Vec3 c, Vec3 d, std::size_t material) {
        scene.meshes.push_back(quad(a, b, c, d, material));
    };
    add({-1, -1, 1}, {1, -1, 1}, {1, -1, -1}, {-1, -1, -1}, 0);  // floor
    add({-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}, 0);      // ceiling
    add({-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, 0);  // back
    add({-1, -1, 1}, {-1, -1, -1}, {-1, 1, -1}, {-1, 1, 1}, 1);  // left
    add({1, 1, 1}, {1, 1, -1}, {1, -1, -1}, {1, -1, 1}, 2);      // right
    scene.camera.to_world.rows[2][3] = 3.4F;
    scene.camera.fov_degrees = 40;
    return scene;
}

// A lamp below the middle of the open box's ceiling.
inline Mesh ceiling_lamp() {
    const float r = 0.6F;
    return quad({-r, 0.98F, -r}, {r, 0.98F, -r}, {r, 0.98F, r}, {-r, 0.98F, r}, 0, {3.5F, 3, 2.5F});
}

inline Quadric ball(Vec3 center, float radius, std::size_t material, Rgb emission = {}) {
    Quadric quadric{.shape = Quadric::Shape::Sphere, .material = material, .emission = emission};
    quadric.to_world.rows = {
        {{radius, 0, 0, center.x}, {0, radius, 0, center.y}, {0, 0, radius, center.z}}};
    return quadric;
}

// An octahedron with the normals of the sphere around it.
inline Mesh smooth_octahedron(Vec3 center, float radius, std::size_t material) {
    Mesh mesh;
    mesh.normals = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    for (const Vec3 n : mesh.normals) mesh.positions.push_back(center + radius * n);
    mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                      {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    mesh.material = material;
    return mesh;
}

}  // namespace misbench::test
