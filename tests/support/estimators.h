// Every way to estimate an image that must agree with the others, as rows: a method, its parameters
// and what of a scene's light it finds. A new method is tested by adding rows to estimators().
//
// A path's edges are counted from the camera: x_0 on the lens, x_1 the first vertex. A delta vertex
// scatters by a delta lobe: mirrors, smooth glass and coatings, opacity below 1.
//
// No number of samples that a test can take tells a very narrow lobe from a delta lobe, nor a lamp
// that hardly any ray meets from a point light: what would have to meet them by chance has tails
// too heavy to compare. So both count as what they are like, by measures of the scene.
#pragma once

#include <string>
#include <vector>

#include "renderer/base/parameters.h"
#include "renderer/scene/scene.h"
#include "tests/support/image_agreement.h"

namespace misbench::test {

// Paths of so many edges, both inclusive.
struct PathLengths {
    int min_edges = 1;
    int max_edges = 5;
    bool operator==(const PathLengths&) const = default;
};

// Where an estimator finds all light of those paths.
enum class Coverage : std::uint8_t {
    Nowhere,      // it misses some in any pixel
    SmoothFirst,  // in pixels none of whose x_1 has a delta lobe or a narrow one
    Everywhere,
};

struct SceneTraits {
    bool delta_lobes = false;   // or narrow ones
    bool narrow_lobes = false;  // which are not delta lobes
    bool delta_lights = false;  // or lamps that rays hardly meet
    bool many_lights = false;   // so many that each is hardly ever one chosen among all alike
    bool narrow_view = false;   // light from far outside hardly ever falls where the camera looks
};
SceneTraits traits(const Scene& scene);

struct EstimatorRow {
    std::string name;
    std::string method;
    ParameterMap parameters;
    Coverage (*coverage)(const SceneTraits& scene, PathLengths lengths);
    double bias = 0;  // as in welch_tests: what merging within a radius may blur
};
const std::vector<EstimatorRow>& estimators();

struct ImageRequest {
    PathLengths lengths;
    int width = 32;
    int height = 24;
    std::int64_t samples = 4;  // a seed
};

// The rows that find all light of such paths in some pixels of the scene, which must outlive the
// result.
std::vector<ImageSource> sources(const Scene& scene, const std::string& scene_name,
                                 const ImageRequest& request);

}  // namespace misbench::test
