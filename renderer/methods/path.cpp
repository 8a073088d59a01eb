// Unidirectional path tracing: from the camera, by BSDF sampling, with next event estimation at
// every vertex.
//
// [Kaj86]  J. T. Kajiya, The rendering equation, 1986.
// [VG95]   E. Veach, L. J. Guibas, Optimally combining sampling techniques for Monte Carlo
//          rendering, 1995.
//
// beta   product of f cosθ / p along the path so far, Russian roulette included
// p_b    density of a direction by BSDF sampling, solid angle measure
// p_l    density of the same direction by next event estimation, solid angle measure
#include "renderer/methods/path.h"

#include <array>
#include <optional>

#include "renderer/base/check.h"
#include "renderer/methods/bidirectional.h"
#include "renderer/methods/next_event.h"
#include "renderer/methods/parameters_of.h"
#include "renderer/methods/pass_context.h"
#include "renderer/methods/roulette.h"
#include "renderer/methods/specialize.h"
#include "renderer/mis/heuristics.h"

namespace misbench {
namespace {

struct PathParameters {
    std::int64_t max_depth = 8;
    std::int64_t rr_depth = 5;
    bool nee = true;
    bool bsdf = true;
    std::string mis = "power2";
    std::string light_selection = "power";

    static void fields(auto& self, auto&& field) {
        field("max_depth", self.max_depth, "edges of the longest path, the camera edge included");
        field("rr_depth", self.rr_depth,
              "edges after which Russian roulette may end a path, by its throughput; 0: never");
        field("nee", self.nee, "next event estimation: sample lights at every vertex");
        field("bsdf", self.bsdf,
              "count lights that BSDF sampling runs into and next event estimation finds as well");
        field("mis", self.mis, "heuristic that combines the two, where both are on");
        field("light_selection", self.light_selection, "how one light is chosen among all");
    }

    void check() {
        if (max_depth < 1) throw ParameterError("max_depth", "max_depth must be at least 1");
        if (rr_depth < 0) throw ParameterError("rr_depth", "rr_depth must be at least 0");
        if (!nee && !bsdf) {
            throw ParameterError("bsdf", "nee and bsdf are both off: no light would be found");
        }
        mis = Heuristic::parse(mis).canonical_name();
        find_light_selection(light_selection);
    }
};

class PathTracer final : public Method {
 public:
    explicit PathTracer(PathParameters parameters)
        : parameters_(std::move(parameters)), heuristic_(Heuristic::parse(parameters_.mis)) {}

    // Samples are shown by the bidirectional method without light paths: it is slower, but draws
    // the same random numbers in the same order. It has no such technique as bsdf=false leaves.
    bool attach(SampleObserver& observer) override {
        if (!parameters_.bsdf) return false;
        shown_ = make_bidirectional({.max_depth = parameters_.max_depth,
                                     .rr_depth = parameters_.rr_depth,
                                     .hit = true,
                                     .shadow_rays = parameters_.nee ? 1 : 0,
                                     .weights = {.mis = parameters_.mis},
                                     .light_selection = parameters_.light_selection});
        return shown_->attach(observer);
    }

    void start(const Scene& scene, FrameInfo frame) override {
        if (shown_) return shown_->start(scene, frame);
        next_event_.emplace(scene, find_light_selection(parameters_.light_selection));
    }

    void pass(PassContext& context) override {
        if (shown_) return shown_->pass(context);
        specialize(context.scene(), [&]<bool kPlain>() {
            context.for_each_pixel([this](const CameraSample& sample, Rng& rng, RayTracer& tracer) {
                return radiance<kPlain>(sample.ray, rng, tracer);
            });
        });
    }

 private:
    enum Technique : std::size_t { kBsdf, kNextEvent };

    // What is known of a direction that BSDF sampling chose.
    struct Origin {
        bool is_camera = true;  // the rest means nothing
        Vec3 position;
        double p_b = 0;
        bool is_delta = false;
    };

    // The weight of a technique where both are on; they take one sample each.
    double weight(Technique technique, double p_b, double p_l) const {
        if (!parameters_.nee || !parameters_.bsdf) return 1;
        return heuristic_.weight(std::array{p_b, p_l}, technique);
    }

    // The weight of light that an edge ran into; p_l() is its density by next event estimation.
    template <bool kPlain, class Density>
    double hit_weight(const Origin& origin, const Density& p_l) const {
        // Nothing but this edge finds what a camera or a delta lobe sees.
        if (origin.is_camera || (!kPlain && origin.is_delta)) return 1;
        return parameters_.bsdf ? weight(kBsdf, origin.p_b, p_l()) : 0;
    }

    // The radiance along a camera ray, one sample of [Kaj86]'s equation.
    template <bool kPlain>
    Rgb radiance(Ray ray, Rng& rng, RayTracer& tracer) const {
        const Scene& scene = tracer.scene();
        Rgb sum;
        Rgb beta = kWhite;
        float eta = 1;  // of the medium at the path's end over the camera's
        Origin origin;
        for (std::int64_t depth = 1;; ++depth) {
            // Find the vertex at the end of edge `depth`, or light from far outside.
            const std::optional<SurfacePoint> hit = tracer.closest(ray);
            if (!hit) {
                if constexpr (!kPlain) {
                    const Rgb radiance = scene.background(ray.direction);
                    if (radiance == Rgb{}) return sum;
                    const double w = hit_weight<kPlain>(origin, [&] {
                        return next_event_->environment_pdf(origin.position, ray.direction);
                    });
                    sum += static_cast<float>(w) * (beta * radiance);
                }
                return sum;
            }
            const Vec3 wo = -ray.direction;

            // Add light that the edge ran into, weighted against next event estimation.  [VG95]
            if (const Rgb emitted = scene.emitted(*hit, wo); emitted != Rgb{}) {
                const double w = hit_weight<kPlain>(
                    origin, [&] { return next_event_->pdf(origin.position, *hit); });
                sum += static_cast<float>(w) * (beta * emitted);
            }
            if (depth == parameters_.max_depth) return sum;

            // Add light that next event estimation finds from here, weighted against BSDF sampling.
            const BasicBsdf<!kPlain> bsdf(scene, *hit, wo);
            if (parameters_.nee) {
                sum += beta * next_event_->template estimate<kPlain>(
                                  *hit, bsdf, rng, tracer, [this](double p, double p_l) {
                                      return weight(kNextEvent, p, p_l);
                                  });
            }

            // End long paths at random, by the throughput without the scale of refraction. The
            // survival probability is in beta, not in the densities.
            if (parameters_.rr_depth > 0 && depth >= parameters_.rr_depth &&
                !survives(eta * eta * max_channel(beta), rng, beta)) {
                return sum;
            }

            // Continue in a direction sampled from the BSDF.
            const float lobe = rng.uniform();
            const float u = rng.uniform();
            const auto sample = bsdf.sample({lobe, {u, rng.uniform()}});
            if (!sample) return sum;
            MISBENCH_CHECK(sample->pdf > 0);
            beta *= sample->weight;
            if (beta == Rgb{}) return sum;
            eta *= sample->eta;
            origin = {.is_camera = false,
                      .position = hit->position,
                      .p_b = sample->pdf,
                      .is_delta = sample->is_delta};
            ray = {hit->leave(sample->wi), sample->wi};
        }
    }

    PathParameters parameters_;
    Heuristic heuristic_;
    std::optional<NextEvent> next_event_;
    std::unique_ptr<Method> shown_;
};

std::string limits(const SceneFeatures& scene) {
    if (!scene.delta_lights) return "";
    std::string text = "with nee=false it finds no light of point, spot and directional lights";
    if (scene.delta_lobes) text += "; never their light by way of mirrors, glass and masks";
    return text;
}

}  // namespace

const MethodInfo kPath = method_info_of<PathTracer, PathParameters>(
    "path", "path tracing with next event estimation", 2, false, limits);

}  // namespace misbench
