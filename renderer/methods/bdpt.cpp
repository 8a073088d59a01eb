// Bidirectional path tracing, with the pixel's own light path or with a cache of light vertices.
//
// [VG94]    E. Veach, L. J. Guibas, Bidirectional estimators for light transport, 1994.
// [PRDD15]  S. Popov, R. Ramamoorthi, F. Durand, G. Drettakis, Probabilistic connections for
//           bidirectional path tracing, 2015.
#include "renderer/methods/bdpt.h"

#include "renderer/methods/bidirectional_parameters.h"

namespace misbench {
namespace {

struct BdptParameters {
    PathLengthParameters length;
    LightPathParameters light_paths;
    ConnectionParameters connection;

    static void fields(auto& self, auto&& field) {
        PathLengthParameters::fields(self.length, field);
        LightPathParameters::fields(self.light_paths, field);
        ConnectionParameters::fields(self.connection, field);
    }
    void check() {
        length.check();
        light_paths.check();
        connection.check();
    }
    BidirectionalOptions options() const {
        BidirectionalOptions options;
        length.apply(options);
        light_paths.apply(options);
        connection.apply(options);
        return options;
    }
};

std::string limits(const SceneFeatures& scene) {
    std::string text;
    if (scene.delta_lights && scene.delta_lobes) {
        text =
            "finds no light of point, spot and directional lights where every surface between "
            "two others, or the camera or the light, is a mirror, glass or a mask";
    }
    return text;
}

}  // namespace

const MethodInfo kBdpt =
    bidirectional_info<BdptParameters>("bdpt", "bidirectional path tracing", 2, limits);

}  // namespace misbench
