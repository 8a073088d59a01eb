// Vertex connection and merging: bidirectional path tracing, with photon mapping as one more family
// of techniques. Biased by the radius.
//
// [GKDS12]  I. Georgiev, J. Křivánek, T. Davidovič, P. Slusallek, Light transport simulation with
//           vertex connection and merging, 2012.
#include "renderer/methods/vcm.h"

#include "renderer/methods/bidirectional_parameters.h"

namespace misbench {
namespace {

struct VcmParameters {
    PathLengthParameters length;
    LightPathParameters light_paths;
    ConnectionParameters connection;
    bool merge = true;
    bool merge_first = false;
    MergeParameters merging;

    static void fields(auto& self, auto&& field) {
        PathLengthParameters::fields(self.length, field);
        LightPathParameters::fields(self.light_paths, field);
        ConnectionParameters::fields(self.connection, field);
        field("merge", self.merge, "camera vertices that gather photons around them");
        field("merge_first", self.merge_first,
              "gather at a camera path's first vertex too, which blurs what light paths find");
        MergeParameters::fields(self.merging, field);
    }
    void check() {
        length.check();
        light_paths.check();
        connection.check();
        merging.check();
    }
    BidirectionalOptions options() const {
        BidirectionalOptions options{.merge = merge, .merge_first = merge_first};
        length.apply(options);
        light_paths.apply(options);
        connection.apply(options);
        merging.apply(options);
        return options;
    }
};

}  // namespace

const MethodInfo kVcm = bidirectional_info<VcmParameters>(
    "vcm", "vertex connection and merging, biased by the radius", 2, limits_of_merging);

}  // namespace misbench
