#include "experiments/extremes/extreme_scenes.h"

#include <array>

namespace misbench::extremes {
namespace {

SurfaceMaterial surface(std::string name, const Material& material) {
    return {.name = std::move(name), .front = {.layer = {.material = material}}};
}

SurfaceMaterial matte(std::string name, Rgb reflectance) {
    return surface(std::move(name), DiffuseMaterial{reflectance});
}

// Applies a map of points and one of directions to everything that has a place.
template <class PointMap, class DirectionMap>
SceneDescription mapped(SceneDescription scene, const PointMap& point,
                        const DirectionMap& direction) {
    for (Mesh& mesh : scene.meshes) {
        for (Vec3& p : mesh.positions) p = point(p);
        for (Vec3& n : mesh.normals) n = direction(n);
    }
    Transform& camera = scene.camera.to_world;
    const Vec3 x = direction(camera.direction({1, 0, 0}));
    const Vec3 y = direction(camera.direction({0, 1, 0}));
    const Vec3 z = direction(camera.direction({0, 0, 1}));
    const Vec3 t = point(camera.translation());
    camera.rows = {{{x.x, y.x, z.x, t.x}, {x.y, y.y, z.y, t.y}, {x.z, y.z, z.z, t.z}}};
    return scene;
}

// A camera at `eye` that looks at `target`, up towards +y.
Transform look_at(Vec3 eye, Vec3 target) {
    const Vec3 back = normalized(eye - target);
    const Vec3 right = normalized(cross({0, 1, 0}, back));
    const Vec3 up = cross(back, right);
    Transform camera;
    camera.rows = {{{right.x, up.x, back.x, eye.x},
                    {right.y, up.y, back.y, eye.y},
                    {right.z, up.z, back.z, eye.z}}};
    return camera;
}

enum class Looks { Inwards, Outwards };

// The six faces of the box between two corners; face 0 to 5: floor, ceiling, back, front, left,
// right.
std::array<Mesh, 6> box(Vec3 low, Vec3 high, Looks looks, std::size_t material) {
    const Vec3 x{high.x - low.x, 0, 0};
    const Vec3 y{0, high.y - low.y, 0};
    const Vec3 z{0, 0, high.z - low.z};
    const auto face = [&](Vec3 corner, Vec3 u, Vec3 v) {
        return looks == Looks::Inwards ? grid(corner, u, v, 1, 1, material)
                                       : grid(corner, v, u, 1, 1, material);
    };
    return {face(low, z, x),     face(low + y, x, z), face(low, x, y),
            face(low + z, y, x), face(low, y, z),     face(low + x, z, y)};
}

SceneDescription world_times_1e_minus_6() { return scaled(turned(room()), 1e-6F); }
SceneDescription world_times_1e6() { return scaled(turned(room()), 1e6F); }
SceneDescription far_from_origin() { return translated(turned(room()), {1e5F, -1e5F, 1e5F}); }

SceneDescription tiny_light() {
    return turned(floor_and_lamp({.lamp_height = kTinyLampHeight,
                                  .lamp_width = kTinyLampSide,
                                  .lamp_depth = kTinyLampSide,
                                  .radiance = kTinyLampRadiance * kWhite}));
}

SceneDescription million_lights() {
    return turned(floor_and_lamp({.lamp_cells_x = 1000, .lamp_cells_z = 500}));
}

SceneDescription million_triangles() {
    return turned(floor_and_lamp({.floor_cells_x = 1000, .floor_cells_z = 500}));
}

// Strips of 10 m by 10 µm, and of 1 m by 1 µm where the lamp is. Not turned: rounding the corners
// would tilt every strip.
SceneDescription slivers() {
    return floor_and_lamp({.lamp_width = 1,
                           .lamp_depth = 0.1F,
                           .lamp_cells_z = 100'000,
                           .floor_width = 10,
                           .floor_depth = 0.1F,
                           .floor_cells_z = 10'000});
}

SceneDescription coincident_surfaces() {
    SceneDescription scene = turned(floor_and_lamp({}));
    for (int copy = 0; copy < 2; ++copy) scene.meshes.push_back(scene.meshes[0]);
    return scene;
}

// Beside the lamp, emitters without area: a triangle that is a point, one that is a segment, one
// with two equal corners. Not turned: rounding would give the segment an area.
SceneDescription zero_area_emitters() {
    SceneDescription scene = floor_and_lamp({});
    Mesh mesh;
    mesh.name = "emitters without area";
    mesh.positions = {{0, 1, 0}, {0, 1, 0.25F}, {0, 1, 0.5F}};
    mesh.triangles = {{0, 0, 0}, {0, 1, 2}, {0, 2, 2}};
    mesh.material = 1;
    mesh.emission = {1e6F, 1e6F, 1e6F};
    scene.meshes.push_back(std::move(mesh));
    return scene;
}

SceneDescription no_light() {
    SceneDescription scene = turned(room());
    for (Mesh& mesh : scene.meshes) mesh.emission = {};
    return scene;
}

SceneDescription deep_white_box() { return turned(white_box(0.999F)); }

// A block of almost air in a box whose walls emit 1 and reflect nothing: radiance is 1 everywhere.
SceneDescription glass_of_almost_air() {
    SceneDescription scene = white_box(0);
    scene.materials.push_back(
        surface("glass", DielectricMaterial(DielectricMaterial::Parameters{.eta = 1.0001F})));
    for (Mesh& face : box({-0.4F, -0.5F, -0.9F}, {0.3F, 0.3F, -0.3F}, Looks::Outwards, 1)) {
        scene.meshes.push_back(std::move(face));
    }
    return turned(std::move(scene));
}

SceneDescription mirror_corridor() {
    SceneDescription scene;
    scene.materials = {
        surface("mirror", ConductorMaterial({.specular_reflectance = kMirrorReflectance * kWhite})),
        matte("black", {})};
    const float w = kCorridorHalfWidth;
    const float l = kCorridorLength;
    const float h = kCorridorLength;
    scene.meshes = {
        grid({-w, -h, -l}, {0, 2 * h, 0}, {0, 0, l}, 1, 1, 0),
        grid({w, -h, -l}, {0, 0, l}, {0, 2 * h, 0}, 1, 1, 0),
        grid({-w, -h, -l}, {2 * w, 0, 0}, {0, 2 * h, 0}, 1, 1, 1, kWhite),
    };
    scene.camera.fov_degrees = 60;
    return turned(std::move(scene));
}

SceneDescription hot_texel() {
    SceneDescription scene;
    scene.materials = {matte("floor", kFloorAlbedo * kWhite)};
    scene.meshes = {grid({-50, 0, -50}, {0, 0, 100}, {100, 0, 0}, 1, 1, 0)};
    auto map = std::make_shared<Image>(kHotMapWidth, kHotMapHeight);
    for (float& value : map->rgb) value = 1;
    for (std::size_t channel = 0; channel < 3; ++channel) {
        map->rgb[static_cast<std::size_t>(3 * (kHotRow * kHotMapWidth + kHotColumn)) + channel] =
            kHotRadiance;
    }
    scene.environment = EnvironmentDescription{.radiance = std::move(map)};
    scene.camera.to_world = look_at({0, 1, 4}, {0, 0, 0});
    scene.camera.fov_degrees = 0.01F;
    return scene;
}

constexpr std::array kScenes{
    ExtremeScene{"world-1e-6", "the room, a millionth of its size", world_times_1e_minus_6},
    ExtremeScene{"world-1e6", "the room, a million times its size", world_times_1e6},
    ExtremeScene{"far-from-origin", "the room, 1e5 units off the origin on every axis",
                 far_from_origin},
    ExtremeScene{"tiny-light", "a lamp of 1e-10 square units with radiance 1e12", tiny_light},
    ExtremeScene{"million-lights", "a lamp of 1e6 triangles", million_lights},
    ExtremeScene{"million-triangles", "a floor of 1e6 triangles", million_triangles},
    ExtremeScene{"slivers", "floor and lamp of triangles 1e6 times as long as wide", slivers},
    ExtremeScene{"coincident-surfaces", "three floors in one place", coincident_surfaces},
    ExtremeScene{"zero-area-emitters", "emissive triangles without area", zero_area_emitters},
    ExtremeScene{"no-light", "the room without its lamp", no_light},
    ExtremeScene{"white-box", "a closed box of albedo 0.999 that emits 1", deep_white_box},
    ExtremeScene{"almost-air", "a block of refractive index 1.0001", glass_of_almost_air},
    ExtremeScene{"mirror-corridor", "two mirrors, 100 times as long as they are apart",
                 mirror_corridor},
    ExtremeScene{"hot-texel", "an environment map of 1 with one texel of 1e6", hot_texel},
};

}  // namespace

std::span<const ExtremeScene> extreme_scenes() { return kScenes; }

Mesh grid(Vec3 corner, Vec3 u, Vec3 v, int nu, int nv, std::size_t material, Rgb emission) {
    Mesh mesh;
    mesh.material = material;
    mesh.emission = emission;
    for (int j = 0; j <= nv; ++j) {
        for (int i = 0; i <= nu; ++i) {
            const float s = static_cast<float>(i) / static_cast<float>(nu);
            const float t = static_cast<float>(j) / static_cast<float>(nv);
            mesh.positions.push_back(corner + s * u + t * v);
        }
    }
    for (int j = 0; j < nv; ++j) {
        for (int i = 0; i < nu; ++i) {
            const auto a = static_cast<std::uint32_t>(j * (nu + 1) + i);
            const auto d = a + static_cast<std::uint32_t>(nu + 1);
            mesh.triangles.push_back({a, a + 1, d + 1});
            mesh.triangles.push_back({a, d + 1, d});
        }
    }
    return mesh;
}

SceneDescription turned(SceneDescription scene) {
    // Columns of a rotation by about 77° around an axis of no symmetry.
    const Frame frame = Frame::from_z(normalized({0.48F, -0.61F, 0.35F}));
    const auto rotate = [&frame](Vec3 v) { return frame.to_world(v); };
    return mapped(std::move(scene), rotate, rotate);
}

SceneDescription scaled(SceneDescription scene, float scale) {
    return mapped(
        std::move(scene), [scale](Vec3 p) { return scale * p; }, [](Vec3 v) { return v; });
}

SceneDescription translated(SceneDescription scene, Vec3 by) {
    return mapped(
        std::move(scene), [by](Vec3 p) { return p + by; }, [](Vec3 v) { return v; });
}

SceneDescription room() {
    SceneDescription scene;
    scene.materials = {matte("white", {0.75F, 0.75F, 0.75F}), matte("red", {0.7F, 0.1F, 0.08F}),
                       matte("green", {0.1F, 0.6F, 0.15F}), matte("black", {})};
    auto walls = box({-1, -1, -1.2F}, {1, 1, 2.6F}, Looks::Inwards, 0);
    walls[4].material = 1;
    walls[5].material = 2;
    for (Mesh& wall : walls) scene.meshes.push_back(std::move(wall));
    for (Mesh& face : box({-0.6F, -1, -0.6F}, {-0.1F, 0.2F, 0}, Looks::Outwards, 0)) {
        scene.meshes.push_back(std::move(face));
    }
    scene.meshes.push_back(
        grid({-0.3F, 0.95F, -0.3F}, {0.6F, 0, 0}, {0, 0, 0.5F}, 1, 1, 3, {12, 10, 8}));
    scene.camera.to_world = look_at({0.1F, 0, 2.4F}, {0, -0.1F, 0});
    scene.camera.fov_degrees = 50;
    return scene;
}

SceneDescription white_box(float albedo) {
    SceneDescription scene;
    scene.materials = {matte("white", albedo * kWhite)};
    for (Mesh& face : box({-1, -1, -1}, {1, 1, 1}, Looks::Inwards, 0)) {
        face.emission = kWhite;
        scene.meshes.push_back(std::move(face));
    }
    scene.camera.fov_degrees = 60;
    return scene;
}

SceneDescription floor_and_lamp(const FloorAndLamp& layout) {
    SceneDescription scene;
    scene.materials = {matte("floor", kFloorAlbedo * kWhite), matte("black", {})};
    const auto& [height, w, d, radiance, cells_x, cells_z, fw, fd, floor_x, floor_z] = layout;
    scene.meshes = {
        grid({-fw / 2, 0, -fd / 2}, {0, 0, fd}, {fw, 0, 0}, floor_z, floor_x, 0),
        grid({-w / 2, height, -d / 2}, {w, 0, 0}, {0, 0, d}, cells_x, cells_z, 1, radiance)};
    scene.camera.to_world = look_at({0, 1, 4}, {0, 0, 0});
    scene.camera.fov_degrees = 0.01F;
    return scene;
}

}  // namespace misbench::extremes
