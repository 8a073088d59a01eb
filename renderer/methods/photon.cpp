// Photon mapping: light paths leave photons, which the camera's paths gather where they first meet
// a diffuse surface. Until there, over metal and glass however rough, they are traced as paths are.
// Biased by the radius.
//
// [Jen96]  H. W. Jensen, Global illumination using photon maps, 1996.
// [KZ11]   C. Knaus, M. Zwicker, Progressive photon mapping: a probabilistic approach, 2011.
#include "renderer/methods/photon.h"

#include "renderer/methods/bidirectional_parameters.h"

namespace misbench {
namespace {

struct PhotonParameters {
    PathLengthParameters length;
    LightPathParameters light_paths;
    MergeParameters merging;

    static void fields(auto& self, auto&& field) {
        PathLengthParameters::fields(self.length, field);
        LightPathParameters::fields(self.light_paths, field);
        MergeParameters::fields(self.merging, field);
    }
    void check() const {
        length.check();
        light_paths.check();
        merging.check();
    }
    BidirectionalOptions options() const {
        BidirectionalOptions options{.hit = true,
                                     .merge = true,
                                     .shadow_rays = 1,
                                     .merge_first = true,
                                     .merge_ends_path = true};
        length.apply(options);
        light_paths.apply(options);
        merging.apply(options);
        return options;
    }
};

}  // namespace

const MethodInfo kPhoton = bidirectional_info<PhotonParameters>(
    "photon", "photon mapping, biased by the radius", 1, limits_of_merging);

}  // namespace misbench
