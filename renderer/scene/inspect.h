// What a scene asks of a renderer (its facts), and what in it would spoil a benchmark (warnings).
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/scene/load.h"

namespace misbench {

// How often a type of material is met, by its place in a surface.
struct MaterialUse {
    std::size_t n_front = 0;
    std::size_t n_back = 0;     // of backs of their own
    std::size_t n_blended = 0;  // laid over a front or back
    bool operator==(const MaterialUse&) const = default;
};

struct LightUse {
    std::size_t n = 0;
    Rgb power;  // W into the scene
};

struct TextureFacts {
    std::string kind;  // bitmap, checkerboard
    int width = 0;     // of a bitmap
    int height = 0;
    std::size_t n_bytes = 0;  // 0 where an earlier texture has the same pixels
};

// Of what surfaces use; a material that no surface has is not counted.
struct SceneFacts {
    std::size_t n_triangles = 0;
    std::size_t n_degenerate_triangles = 0;  // left out
    std::size_t n_instances = 0;
    std::map<std::string, std::size_t> quadrics{};  // by shape
    std::size_t n_materials = 0;
    std::map<std::string, MaterialUse> materials{};  // by type
    std::size_t n_black_backs = 0;
    std::size_t n_other_backs = 0;
    std::size_t n_blends = 0;
    std::size_t n_with_opacity = 0;
    std::vector<std::string> lobes{};
    std::map<std::string, LightUse> lights{};  // by type; a triangle that emits is a light
    std::vector<TextureFacts> textures{};
    std::size_t n_texture_bytes = 0;
    std::size_t n_environment_bytes = 0;
    std::size_t n_geometry_bytes = 0;  // without the BVH

    std::size_t n_lights() const;
    Rgb power() const;
};
SceneFacts inspect(const LoadedScene& loaded);

// The names of those that a scene has, as written in SceneFeatures.
std::vector<std::string> names(const SceneFeatures& features);

struct SceneWarning {
    enum class Kind : std::uint8_t {
        NoLight,
        DegenerateTriangles,
        EmitterWithoutArea,
        DuplicateTriangles,
        WindingConflict,
        SharedEdges,
        OpposedNormals,
        OpposedEmitterNormals,
        MissingUv,
        FlippedEmitter,
        CameraInside,
        CameraTooClose,
        BlackImage,
        BadSamples,
    };
    Kind kind;
    std::string object;  // "mesh 3 'lamp' (material 'Light')"; "" where it is not about one
    std::string message;
};
std::string_view name(SceneWarning::Kind kind);

// A mesh or quadric of a description, and where it is in its Scene.
struct SceneObject {
    std::string label;
    bool is_quadric = false;
    std::size_t end = 0;     // index after its last triangle (or quadric) in the Scene
    bool is_closed = false;  // every edge is between two triangles of one winding
};
// The meshes, then the quadrics, both in the description's order.
std::vector<SceneObject> scene_objects(const SceneDescription& description);

// What is wrong with the surfaces as written.
std::vector<SceneWarning> check_description(const SceneDescription& description);

// What the scene and its rays tell: no light, emitters that look the wrong way, a camera in a wall.
// `objects` are those of the scene's description.
//
// An emitter counts as flipped when at least 90 % of the light that it sends ends on the emitter's
// own object or nearer than D, while at least 10 % of the rays from its other side get to another
// object that is farther than D. D is half the diagonal of the emitter's box, but at most 5 % of
// the scene's radius.
//
// A camera is inside geometry when all rays from its position end on the back faces of closed
// opaque objects: where anything else is in sight, the object is a room. It is too close to a
// surface when one of the rays ends nearer than 0.01 % of the scene's radius.
std::vector<SceneWarning> check_scene(const Scene& scene, const std::vector<SceneObject>& objects);

}  // namespace misbench
