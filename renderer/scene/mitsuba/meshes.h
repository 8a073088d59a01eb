// Meshes as Mitsuba makes them: its unit shapes, their way to world space, smooth normals.
//
// [TW98]  G. Thürmer, C. A. Wüthrich, Computing vertex normals from polygonal facets, 1998.
#pragma once

#include "renderer/scene/description.h"

namespace misbench::mitsuba {

// [-1, 1]² at z = 0, looks along +z; uv from (0, 0) to (1, 1).
Mesh rectangle();
// [-1, 1]³, looks outwards; each face has all of uv.
Mesh cube();

// Maps positions and normals, and keeps the front in front under a mirroring map.
void map_mesh(Mesh& mesh, const Transform& to_world);

struct Placement {
    Transform to_world;
    bool face_normals = false;
    bool flip_normals = false;
};
// Brings a mesh of a file to world space with the normals that it is to have.
void place_mesh(Mesh& mesh, const Placement& placement);

}  // namespace misbench::mitsuba
