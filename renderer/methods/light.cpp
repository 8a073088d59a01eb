// Light tracing: paths from the lights, each vertex connected to the camera.
#include "renderer/methods/light.h"

#include "renderer/methods/bidirectional_parameters.h"

namespace misbench {
namespace {

struct LightParameters {
    PathLengthParameters length;
    LightPathParameters light_paths;

    static void fields(auto& self, auto&& field) {
        PathLengthParameters::fields(self.length, field);
        LightPathParameters::fields(self.light_paths, field);
    }
    void check() const {
        length.check();
        light_paths.check();
    }
    BidirectionalOptions options() const {
        BidirectionalOptions options{.light = true};
        length.apply(options);
        light_paths.apply(options);
        return options;
    }
};

std::string limits(const SceneFeatures& scene) {
    if (!scene.delta_lobes) return "";
    return "finds no light that the camera sees by way of mirrors, glass and masks";
}

}  // namespace

const MethodInfo kLight = bidirectional_info<LightParameters>(
    "light", "light tracing: paths from the lights, connected to the camera", 1, limits);

}  // namespace misbench
