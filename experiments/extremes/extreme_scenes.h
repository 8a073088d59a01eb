// Scenes with one extreme each, made in memory: the tests state their right answers, and
// write_extremes writes them as files for `misbench run` (README.md has the list).
#pragma once

#include <span>
#include <string_view>

#include "renderer/scene/description.h"

namespace misbench::extremes {

struct ExtremeScene {
    std::string_view name;
    std::string_view extreme;  // what is
    SceneDescription (*make)();
};

std::span<const ExtremeScene> extreme_scenes();

// A rectangle at `corner` with sides u and v that looks along u × v, of 2 nu nv triangles.
Mesh grid(Vec3 corner, Vec3 u, Vec3 v, int nu, int nv, std::size_t material, Rgb emission = {});

// p -> scale R p + translation for the whole scene, its camera included; the rotation R is of no
// special angle, so that no surface is parallel to an axis.
SceneDescription turned(SceneDescription scene);
SceneDescription scaled(SceneDescription scene, float scale);
// Throughout as float arithmetic has it: far from the origin the corners are rounded.
SceneDescription translated(SceneDescription scene, Vec3 by);

// A closed box with a small lamp below its ceiling, two coloured walls and a tall block, seen from
// inside.
SceneDescription room();

// The box [-1, 1]³ seen from inside, every face emits radiance 1 and reflects `albedo`. Along every
// path of n edges radiance is Σ albedo^k, k < n.
SceneDescription white_box(float albedo);

// A floor of reflectance kFloorAlbedo at y = 0, a black lamp above it that looks down, and a camera
// that sees the floor's point below the lamp's centre and next to nothing else.
inline constexpr float kFloorAlbedo = 0.8F;
struct FloorAndLamp {
    float lamp_height = 1.5F;
    float lamp_width = 1.6F;  // along x
    float lamp_depth = 1;     // along z
    Rgb radiance{5, 5, 5};
    int lamp_cells_x = 1, lamp_cells_z = 1;
    float floor_width = 100;
    float floor_depth = 100;
    int floor_cells_x = 1, floor_cells_z = 1;
};
SceneDescription floor_and_lamp(const FloorAndLamp& layout);

// A lamp of kTinyLampArea that is smaller than anything, and as bright as it takes.
inline constexpr float kTinyLampSide = 1e-5F;  // a square of 1e-4 mm² where the unit is metres
inline constexpr float kTinyLampRadiance = 1e12F;
inline constexpr float kTinyLampHeight = 1.5F;

// Two parallel mirrors of reflectance kMirrorReflectance at x = ± kCorridorHalfWidth, from z = 0 to
// the wall of radiance 1 at z = -kCorridorLength that they end at. The camera stands in the middle
// of the corridor at z = 0, looks along -z and sees no floor: radiance is reflectance^k after the k
// mirrors on the way.
inline constexpr float kMirrorReflectance = 0.9F;
inline constexpr float kCorridorHalfWidth = 0.5F;
inline constexpr float kCorridorLength = 100;

// The map of the scene "hot-texel": all 1 but for one texel.
inline constexpr int kHotMapWidth = 64, kHotMapHeight = 32;
inline constexpr int kHotColumn = 21, kHotRow = 5;
inline constexpr float kHotRadiance = 1e6F;

}  // namespace misbench::extremes
