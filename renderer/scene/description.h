// A scene as an importer reads it: plain data, checked, before anything is built.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "renderer/math/vec.h"
#include "renderer/scene/material.h"

namespace misbench {

using TriangleIndices = std::array<std::uint32_t, 3>;

struct Mesh {
    std::string name;
    std::vector<Vec3> positions;
    std::vector<Vec3> normals;  // unit length, one a vertex, or empty: then the faces are flat
    std::vector<Vec2> uvs;      // one a vertex, or empty
    std::vector<TriangleIndices> triangles;  // counter-clockwise seen from the front
    std::size_t material = 0;                // index into SceneDescription::materials
    Rgb emission;  // radiance on the side of the shading normal; black: no light
};

struct PerspectiveCamera {
    Transform to_world;  // right-handed; looks along -Z, X right, Y up
    float vertical_fov_degrees = 40;
};

struct SceneDescription {
    std::vector<Mesh> meshes;
    std::vector<Material> materials;
    PerspectiveCamera camera;
};

}  // namespace misbench
