// A scene as an importer reads it: plain data, checked, before anything is built.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "renderer/math/vec.h"
#include "renderer/scene/environment.h"
#include "renderer/scene/material.h"
#include "renderer/scene/texture.h"

namespace misbench {

using TriangleIndices = std::array<std::uint32_t, 3>;

inline constexpr std::int32_t kNoTexture = -1;

// A number that may vary over a surface.
struct TexturedNumber {
    float value = 1;
    std::int32_t texture = kNoTexture;  // index into SceneDescription::textures: its luminance
};

// A material, and the textures that replace parts of it at a point.
struct Layer {
    Material material;
    std::int32_t color_texture = kNoTexture;      // for Material's set_color
    std::int32_t roughness_texture = kNoTexture;  // GenericMaterial only: luminance
};

// What one side of a surface is made of: one layer, or two.
struct Side {
    Layer layer;
    std::optional<Layer> other{};                // blended with `layer`
    TexturedNumber other_weight{0, kNoTexture};  // the part of `other`, in [0, 1]
};

struct SurfaceMaterial {
    enum class Back : std::uint8_t {
        Same,   // as the front; the material is told that it is looked at from inside
        Black,  // absorbs everything
        Other,  // its own
    };

    std::string name{};
    Side front{};  // the side of the shading normal
    Back back = Back::Same;
    std::optional<Side> other_back{};  // for Back::Other
    TexturedNumber opacity{};          // the part of light that meets the surface; the rest goes on
};

struct Mesh {
    std::string name{};
    std::vector<Vec3> positions{};
    std::vector<Vec3> normals{};  // unit length, one a vertex, or empty: then the faces are flat
    std::vector<Vec2> uvs{};      // one a vertex, or empty
    std::vector<TriangleIndices> triangles{};  // counter-clockwise seen from the front
    std::size_t material = 0;                  // index into SceneDescription::materials
    Rgb emission{};  // radiance on the side of the shading normal; black: no light
};

// A curved or round surface with an exact intersection, in its own frame:
// Sphere    x² + y² + z² = 1, looks outwards
// Disk      x² + y² <= 1 at z = 0, looks along +z
// Cylinder  x² + y² = 1, 0 <= z <= 1, looks away from its axis; open at both ends
struct Quadric {
    enum class Shape : std::uint8_t { Sphere, Disk, Cylinder };
    Shape shape = Shape::Sphere;
    // Rotation and scale, of one size in all directions; along a cylinder's axis z, and for a
    // disk's z, any size. The normal turns with it; a mirroring map keeps it outside.
    Transform to_world{};
    bool flipped = false;  // looks the other way
    std::string name{};
    std::size_t material = 0;
    Rgb emission{};  // radiance on the side it looks to
};

struct PointLight {
    Vec3 position;
    Rgb intensity;  // W/sr in all directions
};

// Intensity within beam_width of the axis, falling linearly in the angle to 0 at the cutoff angle.
struct SpotLight {
    Vec3 position;
    Vec3 direction;              // unit
    Rgb intensity;               // W/sr on the axis
    float cutoff_angle = 0.35F;  // radians from the axis
    float beam_width = 0.26F;    // radians, <= cutoff_angle
};

// Parallel light from infinitely far.
struct DirectionalLight {
    Vec3 direction;  // unit, in which the light travels
    Rgb irradiance;  // W/m² on a plane across
};

struct PerspectiveCamera {
    Transform to_world{};    // looks along -Z, X right, Y up; may scale, may mirror
    float fov_degrees = 40;  // the full angle along fov_axis of the whole film
    enum class FovAxis : std::uint8_t { Vertical, Horizontal, Diagonal, Smaller, Larger };
    FovAxis fov_axis = FovAxis::Vertical;
    float lens_radius = 0;     // world units; 0: a pinhole
    float focus_distance = 1;  // along the camera's axis, world units
    // The part of the film that becomes the image, in fractions of it from its top left corner.
    struct Window {
        float x0 = 0, y0 = 0, x1 = 1, y1 = 1;
    };
    Window window{};
};

// The size of the image that the file asks for, in pixels; 0: it says nothing. What a run asks for
// goes before.
struct FilmDefaults {
    int width = 0;
    int height = 0;
};

struct SceneDescription {
    std::vector<Mesh> meshes;
    std::vector<Quadric> quadrics;
    std::vector<SurfaceMaterial> materials;
    std::vector<Texture> textures;
    std::optional<EnvironmentDescription> environment;
    std::vector<PointLight> point_lights;
    std::vector<SpotLight> spot_lights;
    std::vector<DirectionalLight> directional_lights;
    PerspectiveCamera camera;
    FilmDefaults film;
    // What the importer converted or chose where the file leaves it open: one line each, for
    // `misbench scene info`.
    std::vector<std::string> notes;
    std::size_t n_instances = 0;  // copies of shape groups, already part of the meshes
};

}  // namespace misbench
