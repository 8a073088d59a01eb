// Affine maps as scene files write and combine them.
#pragma once

#include "renderer/math/vec.h"

namespace misbench::mitsuba {

// `first`, then `second`.
Transform compose(const Transform& second, const Transform& first);
Transform translation(Vec3 by);
Transform scaling(Vec3 by);
// A map with these columns.
Transform from_columns(Vec3 x, Vec3 y, Vec3 z, Vec3 origin);
Vec3 column(const Transform& transform, std::size_t i);

// Of the linear part; below 0 for a mirror, 0 or not finite where it cannot be inverted.
double determinant(const Transform& transform);

// The unit normal of a surface that had normal n before the map; 0 where n has no direction.
Vec3 map_normal(const Transform& transform, Vec3 n);

// The columns i and j are at right angles, as far as the numbers of scene files go.
bool at_right_angles(const Transform& transform, std::size_t i, std::size_t j);
// The columns i and j are of one length, as above.
bool same_length(const Transform& transform, std::size_t i, std::size_t j);
// The columns are of length 1 and at right angles: a rotation, or a mirrored one.
bool is_orthonormal(const Transform& transform);

}  // namespace misbench::mitsuba
