#include "tests/support/estimators.h"

#include <algorithm>

#include "renderer/base/error.h"
#include "renderer/base/rng.h"
#include "renderer/math/warp.h"
#include "renderer/methods/catalogue.h"
#include "renderer/methods/render_loop.h"
#include "renderer/mis/heuristics.h"
#include "renderer/scene/camera.h"

namespace misbench::test {
namespace {

constexpr auto kEverywhere = [](const SceneTraits&, PathLengths) { return Coverage::Everywhere; };
constexpr auto kSmoothFirst = [](const SceneTraits&, PathLengths) { return Coverage::SmoothFirst; };
// Light tracing alone.
constexpr auto kLightPaths = [](const SceneTraits& scene, PathLengths) {
    return scene.narrow_view ? Coverage::Nowhere : Coverage::SmoothFirst;
};
constexpr auto kUniformLightPaths = [](const SceneTraits& scene, PathLengths lengths) {
    return scene.many_lights ? Coverage::Nowhere : kLightPaths(scene, lengths);
};

// Light of point, spot and directional lights that a delta vertex x_{n-1} sends on, n > 2: neither
// next event estimation nor a camera path finds it.
bool has_delta_caustics(const SceneTraits& scene, PathLengths lengths) {
    return scene.delta_lights && scene.delta_lobes && lengths.max_edges > 2;
}
constexpr auto kNoDeltaCaustics = [](const SceneTraits& scene, PathLengths lengths) {
    return has_delta_caustics(scene, lengths) ? Coverage::Nowhere : Coverage::Everywhere;
};
// Light paths find what the camera's miss, if they can be connected with the camera. Connections
// inside of a path need two neighbours that are not delta vertices, which not every path has.
constexpr auto kBidirectional = [](const SceneTraits& scene, PathLengths lengths) {
    return has_delta_caustics(scene, lengths) ? Coverage::SmoothFirst : Coverage::Everywhere;
};
// Weights that do not follow densities leave to light paths what those hardly ever find.
constexpr auto kConstant = [](const SceneTraits& scene, PathLengths lengths) {
    return scene.narrow_view ? Coverage::Nowhere : kBidirectional(scene, lengths);
};
// Next event estimation alone misses what narrow lobes show.
constexpr auto kNoNarrowLobes = [](const SceneTraits& scene, PathLengths lengths) {
    return scene.narrow_lobes ? Coverage::Nowhere : kNoDeltaCaustics(scene, lengths);
};
// Photons are gathered at the first vertex with a diffuse lobe; until there paths are traced.
constexpr auto kGathering = [](const SceneTraits& scene, PathLengths) {
    if (scene.narrow_view) return Coverage::Nowhere;
    return scene.narrow_lobes ? Coverage::SmoothFirst : Coverage::Everywhere;
};
// BSDF sampling alone never meets a light without extent.
constexpr auto kNoDeltaLights = [](const SceneTraits& scene, PathLengths) {
    return scene.delta_lights ? Coverage::Nowhere : Coverage::Everywhere;
};
// Without light that camera paths run into, x_{n-1} must not be a delta vertex; of paths of two
// edges it is x_1.
constexpr auto kLastIsSmooth = [](const SceneTraits& scene, PathLengths lengths) {
    if (!scene.delta_lobes) return Coverage::Everywhere;
    return lengths.max_edges <= 2 ? Coverage::SmoothFirst : Coverage::Nowhere;
};
// Connections or merging alone: all paths must have an inner edge or vertex for it.
constexpr auto kThreeSmoothEdges = [](const SceneTraits& scene, PathLengths lengths) {
    return scene.delta_lobes || lengths.min_edges < 3 ? Coverage::Nowhere : Coverage::Everywhere;
};

template <class Covers>
constexpr auto kDirect = [](const SceneTraits& scene, PathLengths lengths) {
    return lengths == PathLengths{1, 2} ? Covers()(scene, lengths) : Coverage::Nowhere;
};

std::int64_t n(std::int64_t value) { return value; }
std::string text(const char* value) { return value; }

// Light samples resampled as in hua2025 section 6.
ParameterMap by_area(ParameterMap parameters) {
    parameters["candidates"] = n(32);
    parameters["light_selection"] = text("area");
    return parameters;
}
ParameterMap with_factors(const char* factors) {
    return by_area({{"factors", text(factors)},
                    {"variance_variant", text("hua2025")},
                    {"correction_groups", text("hit")},
                    {"correction_keep", false}});
}
ParameterMap nabata_correction() {
    ParameterMap parameters = with_factors("correction");
    parameters["resampled_density"] = text("nabata");
    parameters["precompute"] = n(2);
    return parameters;
}

std::vector<EstimatorRow> unidirectional_rows() {
    return {
        {"path", "path", {}, kNoDeltaCaustics},
        {"path_nee", "path", {{"bsdf", false}}, kNoNarrowLobes},
        {.name = "path_bsdf",
         .method = "path",
         .parameters = {{"nee", false}},
         .coverage = kNoDeltaLights},
        {"path_roulette",
         "path",
         {{"rr_depth", n(1)}, {"light_selection", text("tree")}, {"mis", text("balance")}},
         kNoDeltaCaustics},
        {"direct", "direct", {}, kDirect<decltype(kEverywhere)>},
        {"direct_2_0",
         "direct",
         {{"light_samples", n(2)}, {"bsdf_samples", n(0)}},
         kDirect<decltype(kLastIsSmooth)>},
        {.name = "direct_0_2",
         .method = "direct",
         .parameters = {{"light_samples", n(0)}, {"bsdf_samples", n(2)}},
         .coverage = kDirect<decltype(kNoDeltaLights)>},
        {"direct_4_candidates", "direct", {{"candidates", n(4)}}, kDirect<decltype(kEverywhere)>},
        {"direct_32_candidates", "direct", by_area({}), kDirect<decltype(kEverywhere)>},
        {"direct_nabata", "direct", by_area({{"resampled_density", text("nabata")}}),
         kDirect<decltype(kEverywhere)>},
        {"direct_nabata_2_3",
         "direct",
         {{"candidates", n(4)},
          {"light_samples", n(2)},
          {"bsdf_samples", n(3)},
          {"resampled_density", text("nabata")},
          {"nabata_keep", false},
          {"mis", text("power2")}},
         kDirect<decltype(kEverywhere)>},
        {"direct_variance", "direct", with_factors("variance"), kDirect<decltype(kEverywhere)>},
        {"direct_correction", "direct", with_factors("correction"), kDirect<decltype(kEverywhere)>},
        {"direct_nabata_correction", "direct", nabata_correction(), kDirect<decltype(kEverywhere)>},
        {"light", "light", {}, kLightPaths},
        {"light_roulette", "light", {{"rr_depth", n(1)}, {"light_paths", 0.3}}, kLightPaths},
        {"light_uniform", "light", {{"light_selection", text("uniform")}}, kUniformLightPaths},
    };
}

// One technique switched on of hit, nee, light and connect, so that its weight is 1.
ParameterMap only(const std::string& technique) {
    ParameterMap parameters;
    for (const char* name : {"hit", "nee", "light", "connect"}) {
        parameters[name] = name == technique;
    }
    return parameters;
}

// Factors are learned from the first passes, whose samples the image keeps.
ParameterMap with_factors(const char* factors, ParameterMap parameters) {
    parameters["factors"] = text(factors);
    // Pixels chosen by their samples are a bias, if a small one.
    parameters["variance_keep"] = 1e30;
    return parameters;
}

std::vector<EstimatorRow> bdpt_rows_with_factors() {
    return {
        {"bdpt_correlation", "bdpt", with_factors("correlation", {{"shadow_rays", n(4)}}),
         kBidirectional},
        {"bdpt_popov", "bdpt", with_factors("popov", {{"shadow_rays", n(4)}}), kBidirectional},
        {"bdpt_variance", "bdpt", with_factors("variance", {{"mis", text("power2")}}),
         kBidirectional},
        {"bdpt_reciprocal_variance", "bdpt",
         with_factors("variance",
                      {{"variance_factor", text("reciprocal")}, {"mis", text("constant")}}),
         kConstant},
        {"bdpt_correction", "bdpt",
         with_factors("correction", {{"correction_groups", text("light+nee")}}), kBidirectional},
    };
}

std::vector<EstimatorRow> bdpt_rows() {
    std::vector<EstimatorRow> rows = {
        {"bdpt", "bdpt", {}, kBidirectional},
        {"bdpt_path_pairing", "bdpt", {{"pairing", text("path")}}, kBidirectional},
        {"bdpt_connections_0.5", "bdpt", {{"connections", 0.5}}, kBidirectional},
        {"bdpt_connections_3", "bdpt", {{"connections", 3.0}}, kBidirectional},
        {"bdpt_shadow_rays_2", "bdpt", {{"shadow_rays", n(2)}}, kBidirectional},
        {"bdpt_bsdf_samples_2", "bdpt", {{"bsdf_samples", n(2)}}, kBidirectional},
        {"bdpt_light_paths_0.3", "bdpt", {{"light_paths", 0.3}}, kBidirectional},
        {"bdpt_light_paths_2", "bdpt", {{"light_paths", 2.0}}, kBidirectional},
        {"bdpt_all_numbers",
         "bdpt",
         {{"connections", 1.5},
          {"shadow_rays", n(3)},
          {"bsdf_samples", n(2)},
          {"light_paths", 0.7},
          {"rr_depth", n(1)},
          {"light_selection", text("uniform")}},
         kBidirectional},
        {"bdpt_float", "bdpt", {{"densities", text("float")}}, kBidirectional},
        {"bdpt_no_roulette", "bdpt", {{"rr_depth", n(0)}}, kBidirectional},
        {"bdpt_without_hit", "bdpt", {{"hit", false}}, kSmoothFirst},
        {"bdpt_without_nee", "bdpt", {{"nee", false}}, kSmoothFirst},
        {"bdpt_without_light", "bdpt", {{"light", false}}, kNoDeltaCaustics},
        {"bdpt_without_connect", "bdpt", {{"connect", false}}, kBidirectional},
        {.name = "bdpt_only_hit",
         .method = "bdpt",
         .parameters = only("hit"),
         .coverage = kNoDeltaLights},
        {"bdpt_only_nee", "bdpt", only("nee"), kLastIsSmooth},
        {"bdpt_only_light", "bdpt", only("light"), kLightPaths},
        {"bdpt_only_connect", "bdpt", only("connect"), kThreeSmoothEdges},
    };
    for (const EstimatorRow& row : bdpt_rows_with_factors()) rows.push_back(row);
    for (const MisHeuristic& heuristic : heuristics()) {
        const std::string mis(heuristic.name);
        if (mis == "balance") continue;  // the default
        rows.push_back({"bdpt_" + mis, "bdpt", {{"mis", mis}}, kBidirectional});
        if (mis == "constant") rows.back().coverage = kConstant;
    }
    return rows;
}

// Merging blurs within its radius, here a part of the scene's. Weighed against all other
// techniques, little of that is left. Alone it loses light at edges and finds too much in narrow
// places: around the lamp of LampCaustic 50 % too much with a radius of 1 %, 5 % with these 0.3 %.
constexpr double kVcmBias = 0.01;
constexpr double kMergeBias = 0.1;

ParameterMap with_radius(ParameterMap parameters, double scale) {
    parameters["radius"] = text("global");
    parameters["radius_scale"] = scale;
    return parameters;
}
ParameterMap among_others(ParameterMap parameters) {
    return with_radius(std::move(parameters), 2e-3);
}
ParameterMap alone(ParameterMap parameters) {
    parameters["light_paths"] = 4.0;
    return with_radius(std::move(parameters), 3e-3);
}

std::vector<EstimatorRow> merging_rows() {
    ParameterMap only_merge = only("none of these");
    only_merge["merge"] = true;
    return {
        {"vcm", "vcm", among_others({}), kEverywhere, kVcmBias},
        {"vcm_merge_first", "vcm", among_others({{"merge_first", true}}), kEverywhere, kVcmBias},
        {"vcm_path_pairing", "vcm", among_others({{"pairing", text("path")}}), kEverywhere,
         kVcmBias},
        {"vcm_all_numbers", "vcm",
         among_others({{"connections", 1.5},
                       {"shadow_rays", n(2)},
                       {"bsdf_samples", n(2)},
                       {"light_paths", 0.7},
                       {"kernel", text("constant")}}),
         kEverywhere, kVcmBias},
        {"vcm_correlation", "vcm", among_others(with_factors("correlation", {})), kEverywhere,
         kVcmBias},
        {"vcm_jendersie", "vcm", among_others(with_factors("jendersie", {})), kEverywhere,
         kVcmBias},
        {"vcm_variance", "vcm",
         among_others(with_factors("variance", {{"variance_variant", text("hua2025")}})),
         kEverywhere, kVcmBias},
        {"vcm_correlation_correction", "vcm",
         among_others(with_factors("correlation+correction", {})), kEverywhere, kVcmBias},
        {"vcm_variance_correction", "vcm", among_others(with_factors("variance+correction", {})),
         kEverywhere, kVcmBias},
        {"vcm_without_merge", "vcm", {{"merge", false}}, kBidirectional},
        {"vcm_only_merge", "vcm", alone(only_merge), kThreeSmoothEdges, kMergeBias},
        {"photon", "photon", alone({}), kGathering, kMergeBias},
        {"photon_constant", "photon", alone({{"kernel", text("constant")}}), kGathering,
         kMergeBias},
    };
}

bool takes(const MethodInfo& method, const std::string& parameter) {
    const std::vector<ParameterInfo> all = method.parameters();
    return std::any_of(all.begin(), all.end(),
                       [&](const ParameterInfo& info) { return info.name == parameter; });
}

Image render_valid(const Scene& scene, const MethodInfo& method, const ParameterMap& parameters,
                   const ImageRequest& request, std::int64_t seed) {
    RenderResult result = render(scene, method,
                                 {.method = std::string(method.name),
                                  .parameters = parameters,
                                  .width = request.width,
                                  .height = request.height,
                                  .budget = SampleBudget{request.samples},
                                  .seed = seed});
    if (!result.valid) {
        throw Error(Errc::Internal, "seed " + std::to_string(seed) + ": " +
                                        std::to_string(result.statistics.nonfinite_samples) +
                                        " samples are not finite, " +
                                        std::to_string(result.statistics.negative_samples) +
                                        " negative");
    }
    return std::move(result.image);
}

Image image_of(const Scene& scene, const EstimatorRow& row, const ImageRequest& request,
               std::int64_t seed) {
    const MethodInfo& method = find_method(row.method);
    const auto [min_edges, max_edges] = request.lengths;
    ParameterMap parameters = row.parameters;
    // A method without this parameter has the lengths that it covers.
    if (takes(method, "max_depth")) parameters["max_depth"] = std::int64_t{max_edges};
    if (takes(method, "min_depth")) parameters["min_depth"] = std::int64_t{min_edges};
    Image image = render_valid(scene, method, parameters, request, seed);
    if (takes(method, "min_depth") || min_edges == 1) return image;
    // Take away the shorter paths. The same seed gives the same ones, so that none of their noise
    // is left.
    parameters["max_depth"] = std::int64_t{min_edges - 1};
    const Image shorter = render_valid(scene, method, parameters, request, seed);
    for (std::size_t i = 0; i < image.rgb.size(); ++i) image.rgb[i] -= shorter.rgb[i];
    return image;
}

// Of more than this density a lobe is narrow: 1/sr, of directions chosen at normal incidence. The
// peak of microfacets with α = 0.03 has it.
constexpr double kNarrow = 100;
// Rays meet lamps in less than this part of directions: they are like points.
constexpr double kHardly = 0.02;
constexpr std::size_t kManyLights = 16;

bool is_narrow(const Material& material) {
    for (std::uint32_t i = 0; i < 256; ++i) {
        Rng rng(2, i, 0);
        const float lobe = rng.uniform();
        const float u = rng.uniform();
        const auto direction = sample(material, {.wo = {0, 0, 1}}, {lobe, {u, rng.uniform()}});
        if (direction && !direction->is_delta && direction->pdf > kNarrow) return true;
    }
    return false;
}

bool is_narrow(const SurfaceMaterial& material) {
    std::vector<const Side*> sides = {&material.front};
    if (material.other_back) sides.push_back(&*material.other_back);
    return std::any_of(sides.begin(), sides.end(), [](const Side* side) {
        return is_narrow(side->layer.material) || (side->other && is_narrow(side->other->material));
    });
}

// The part of random directions from random points that the camera sees in which there is light.
double chance_of_light(const Scene& scene) {
    constexpr std::uint32_t kSide = 64;
    const Camera camera(scene.camera(), kSide, kSide);
    int n_points = 0;
    int n_lit = 0;
    for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
        Rng rng(3, i, 0);
        const Vec2 film = {static_cast<float>(i % kSide), static_cast<float>(i / kSide)};
        const auto point = scene.closest(camera.ray(film, {0.5F, 0.5F}));
        if (!point) continue;
        for (int k = 0; k < 16; ++k) {
            const float u = rng.uniform();
            const Vec3 w = warp_sphere({u, rng.uniform()});
            const auto hit = scene.closest({point->leave(w), w});
            const Rgb light = hit ? scene.emitted(*hit, -w) : scene.background(w);
            ++n_points;
            if (light != Rgb{}) ++n_lit;
        }
    }
    return n_points > 0 ? static_cast<double>(n_lit) / n_points : 0;
}

// What the camera sees of surfaces, as a part of the disk through which light comes from outside.
double part_in_view(const Scene& scene) {
    constexpr std::uint32_t kSide = 64;
    const Camera camera(scene.camera(), kSide, kSide);
    double area = 0;
    for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
        const Vec2 film = {static_cast<float>(i % kSide), static_cast<float>(i / kSide)};
        const Ray ray = camera.ray(film, {0.5F, 0.5F});
        const auto point = scene.closest(ray);
        if (!point) continue;
        // A pixel's solid angle times the squared distance: across the view.
        area += squared_length(point->position - ray.origin) / camera.pdf_direction(ray.direction);
    }
    return area / (M_PI * double{scene.radius()} * double{scene.radius()});
}

// The pixels in which no camera ray, of many, meets a surface with such a lobe, and whose
// neighbours are such pixels too.
PixelMask smooth_first(const Scene& scene, int width, int height) {
    constexpr int kRays = 64;
    const std::span<const SurfaceMaterial> materials = scene.materials();
    std::vector<bool> is_hard;
    for (const SurfaceMaterial& material : materials) {
        is_hard.push_back((lobes(material) & kDeltaLobe) != 0 || is_narrow(material));
    }
    const Camera camera(scene.camera(), width, height);
    PixelMask mask(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 1);
    const auto exclude_around = [&](int x, int y) {
        for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v) {
            for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u) {
                mask[static_cast<std::size_t>(v * width + u)] = 0;
            }
        }
    };
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            Rng rng(1, static_cast<std::uint32_t>(y * width + x), 0);
            for (int i = 0; i < kRays; ++i) {
                const float dx = rng.uniform();
                const float dy = rng.uniform();
                const float u = rng.uniform();
                const Vec2 film = {static_cast<float>(x) + dx, static_cast<float>(y) + dy};
                const auto hit = scene.closest(camera.ray(film, {u, rng.uniform()}));
                if (hit && is_hard[static_cast<std::size_t>(hit->material - materials.data())]) {
                    exclude_around(x, y);
                    break;
                }
            }
        }
    }
    return mask;
}

}  // namespace

const std::vector<EstimatorRow>& estimators() {
    static const std::vector<EstimatorRow> kRows = [] {
        std::vector<EstimatorRow> all = unidirectional_rows();
        for (const auto& rows : {bdpt_rows(), merging_rows()}) {
            all.insert(all.end(), rows.begin(), rows.end());
        }
        return all;
    }();
    return kRows;
}

SceneTraits traits(const Scene& scene) {
    const auto materials = scene.materials();
    SceneTraits result;
    result.narrow_lobes =
        std::any_of(materials.begin(), materials.end(),
                    [](const SurfaceMaterial& material) { return is_narrow(material); });
    result.delta_lobes = result.narrow_lobes || scene.features().delta_lobes;
    result.delta_lights = scene.features().delta_lights || chance_of_light(scene) < kHardly;
    result.many_lights = scene.lights().size() > kManyLights;
    result.narrow_view = scene.features().environment && part_in_view(scene) < kHardly;
    return result;
}

std::vector<ImageSource> sources(const Scene& scene, const std::string& scene_name,
                                 const ImageRequest& request) {
    const PixelMask smooth = smooth_first(scene, request.width, request.height);
    const bool any_smooth = std::find(smooth.begin(), smooth.end(), 1) != smooth.end();
    const SceneTraits scene_traits = traits(scene);
    std::vector<ImageSource> all;
    for (const EstimatorRow& row : estimators()) {
        const Coverage coverage = row.coverage(scene_traits, request.lengths);
        if (coverage == Coverage::Nowhere) continue;
        if (coverage == Coverage::SmoothFirst && !any_smooth) continue;
        const auto image = [&scene, &row, scene_name, request](std::int64_t seed) {
            try {
                return image_of(scene, row, request, seed);
            } catch (const Error& error) {
                throw Error(error.code(), "scene '" + scene_name + "': estimator '" + row.name +
                                              "': " + error.what());
            }
        };
        all.push_back(
            {.name = row.name,
             .image = image,
             .mask = coverage == Coverage::Everywhere ? PixelMask(smooth.size(), 1) : smooth,
             .bias = row.bias});
    }
    return all;
}

}  // namespace misbench::test
