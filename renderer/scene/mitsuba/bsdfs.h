// Materials, each read when the first shape uses it: an unused one that cannot be modelled is no
// error.
#pragma once

#include <map>

#include "renderer/scene/mitsuba/context.h"
#include "renderer/scene/mitsuba/object.h"
#include "renderer/scene/mitsuba/textures.h"

namespace misbench::mitsuba {

class Bsdfs {
 public:
    explicit Bsdfs(Context& context) : context_(context), textures_(context) {}

    // Indices into SceneDescription::materials.
    std::size_t index_of(Object& object);
    // Of shapes that name none: grey, seen from the front.
    std::size_t default_index(bool emits);

 private:
    SurfaceMaterial read_surface(Object& object);
    SurfaceMaterial read_twosided(Object& object);
    SurfaceMaterial read_mask(Object& object);
    SurfaceMaterial read_blend(Object& object);
    // One that is neither of the above; its parameters are checked.
    SurfaceMaterial read_simple(Object& object);

    Context& context_;
    Textures textures_;
    std::map<const Object*, std::size_t> indices_;
    std::map<bool, std::size_t> default_indices_;
};

}  // namespace misbench::mitsuba
