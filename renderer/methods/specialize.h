// Render loops for what a scene requires: one for plain scenes, that tests for nothing they lack,
// and one for all others.
#pragma once

#include "renderer/scene/bsdf.h"

namespace misbench {

// A plain scene is made of triangles, each surface one constant material that is the same on both
// sides and has no delta lobes, and all lights are triangles.
inline bool is_plain(const SceneFeatures& scene) { return scene == SceneFeatures{}; }

// Calls loop.operator()<kPlain>(). The general loop is right for every scene, and gives a plain one
// the same bits.
template <class Loop>
void specialize(const Scene& scene, const Loop& loop) {
    if (is_plain(scene.features())) {
        loop.template operator()<true>();
    } else {
        loop.template operator()<false>();
    }
}

}  // namespace misbench
