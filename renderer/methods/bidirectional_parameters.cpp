#include "renderer/methods/bidirectional_parameters.h"

#include <array>

#include "renderer/base/error.h"
#include "renderer/scene/light_sampler.h"

namespace misbench {
namespace {

constexpr std::int64_t kMaxSamples = 1024;
constexpr double kMaxConnections = 1024;

template <class T>
struct Choice {
    const char* name;
    T value;
};

constexpr std::array kPairings{Choice{"cache", false}, Choice{"path", true}};
constexpr std::array kPrecisions{Choice{"double", DensityPrecision::Double},
                                 Choice{"float", DensityPrecision::Float}};
constexpr std::array kRadiusUnits{Choice{"footprint", RadiusUnit::Footprint},
                                  Choice{"distance", RadiusUnit::Distance},
                                  Choice{"global", RadiusUnit::Global}};
constexpr std::array kKernels{Choice{"epanechnikov", MergeKernel::Epanechnikov},
                              Choice{"constant", MergeKernel::Constant}};

template <class Choices>
auto choose(const Choices& choices, const char* parameter, const std::string& name) {
    std::string known;
    for (const auto& choice : choices) {
        if (name == choice.name) return choice.value;
        known += std::string(" ") + choice.name;
    }
    throw ParameterError(parameter, std::string(parameter) + " is '" + name + "'; known:" + known);
}

}  // namespace

void PathLengthParameters::check() const {
    constexpr std::int64_t kMaxDepth = 1'000'000;
    check_range("max_depth", max_depth, std::int64_t{1}, kMaxDepth);
    check_range("min_depth", min_depth, std::int64_t{1}, max_depth);
    check_range("rr_depth", rr_depth, std::int64_t{0}, kMaxDepth);
}

void PathLengthParameters::apply(BidirectionalOptions& options) const {
    options.max_depth = max_depth;
    options.min_depth = min_depth;
    options.rr_depth = rr_depth;
}

void LightPathParameters::check() const {
    check_range("light_paths", light_paths, 0.0, 1e6);
    find_light_selection(light_selection);
}

void LightPathParameters::apply(BidirectionalOptions& options) const {
    options.light_paths = light_paths;
    options.light_selection = light_selection;
}

void ConnectionParameters::check() {
    weights.check();
    choose(kPrecisions, "densities", densities);
    check_range("shadow_rays", shadow_rays, std::int64_t{1}, kMaxSamples);
    check_range("bsdf_samples", bsdf_samples, std::int64_t{1}, kMaxSamples);
    check_range("connections", connections, 0.0, kMaxConnections);
    if (choose(kPairings, "pairing", pairing) && connections != 1) {
        throw ParameterError("connections",
                             "connections must be 1 with pairing=path, which connects to every "
                             "vertex of one light path");
    }
}

void ConnectionParameters::apply(BidirectionalOptions& options) const {
    options.hit = hit;
    options.shadow_rays = nee ? shadow_rays : 0;
    options.light = light;
    options.connect = connect && connections > 0;
    options.paired = choose(kPairings, "pairing", pairing);
    options.connections = connections;
    options.bsdf_samples = bsdf_samples;
    options.weights = weights;
    options.precision = choose(kPrecisions, "densities", densities);
}

void MergeParameters::check() const {
    choose(kRadiusUnits, "radius", radius);
    choose(kKernels, "kernel", kernel);
    check_range("radius_scale", radius_scale, 1e-12, 1e12);
    check_range("radius_shrink", radius_shrink, 0.0, 1.0);
}

void MergeParameters::apply(BidirectionalOptions& options) const {
    options.radius_unit = choose(kRadiusUnits, "radius", radius);
    options.radius_scale = radius_scale;
    options.radius_shrink = radius_shrink;
    options.kernel = choose(kKernels, "kernel", kernel);
}

std::string limits_of_merging(const SceneFeatures& scene) {
    if (!scene.delta_lights || !scene.delta_lobes) return "";
    return "finds no light of point, spot and directional lights by way of nothing but mirrors, "
           "glass and masks";
}

}  // namespace misbench
