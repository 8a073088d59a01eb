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
#include "renderer/methods/next_event.h"
#include "renderer/methods/parameters_of.h"
#include "renderer/methods/pass_context.h"
#include "renderer/mis/heuristics.h"
#include "renderer/scene/bsdf.h"

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
              "edges after which Russian roulette may end a path, by its throughput");
        field("nee", self.nee, "next event estimation: sample lights at every vertex");
        field("bsdf", self.bsdf, "count lights that BSDF sampling runs into");
        field("mis", self.mis, "heuristic that combines the two, where both are on");
        field("light_selection", self.light_selection, "how one light is chosen among all");
    }

    void check() {
        if (max_depth < 1) throw ParameterError("max_depth", "max_depth must be at least 1");
        if (rr_depth < 1) throw ParameterError("rr_depth", "rr_depth must be at least 1");
        if (!nee && !bsdf) {
            throw ParameterError("bsdf", "nee and bsdf are both off: no light would be found");
        }
        mis = Heuristic::parse(mis).canonical_name();
        find_light_selection(light_selection);
    }
};

// Survival never falls below this part, nor rises above it: a path of white walls must end too.
constexpr float kMaxSurvival = 0.95F;

class PathTracer final : public Method {
 public:
    explicit PathTracer(PathParameters parameters)
        : parameters_(std::move(parameters)), heuristic_(Heuristic::parse(parameters_.mis)) {}

    void start(const Scene& scene, FrameInfo /*frame*/) override {
        next_event_.emplace(scene, find_light_selection(parameters_.light_selection));
    }

    void pass(PassContext& context) override {
        context.for_each_pixel([this](const Ray& ray, Rng& rng, RayTracer& tracer) {
            return radiance(ray, rng, tracer);
        });
    }

 private:
    enum Technique : std::size_t { kBsdf, kNextEvent };

    // The weight of a technique where both are on; they take one sample each.
    double weight(Technique technique, double p_b, double p_l) const {
        if (!parameters_.nee || !parameters_.bsdf) return 1;
        return heuristic_.weight(std::array{p_b, p_l}, technique);
    }

    // The radiance along a camera ray, one sample of [Kaj86]'s equation.
    Rgb radiance(Ray ray, Rng& rng, RayTracer& tracer) const {
        Rgb sum;
        Rgb beta = kWhite;
        double p_b = 0;
        std::optional<SurfacePoint> previous;
        for (std::int64_t depth = 1;; ++depth) {
            // Find the vertex at the end of edge `depth`.
            const std::optional<SurfacePoint> hit = tracer.closest(ray);
            if (!hit) return sum;
            const Vec3 wo = -ray.direction;

            // Add light that the edge ran into, weighted against next event estimation.  [VG95]
            if (const Rgb emitted = tracer.scene().emitted(*hit, wo); emitted != Rgb{}) {
                if (!previous) {
                    sum += emitted;
                } else if (parameters_.bsdf) {
                    const double p_l = next_event_->pdf(*previous, *hit);
                    sum += static_cast<float>(weight(kBsdf, p_b, p_l)) * (beta * emitted);
                }
            }
            if (depth == parameters_.max_depth) return sum;

            // Add light that next event estimation finds from here, weighted against BSDF sampling.
            const Bsdf bsdf(*hit, wo);
            if (parameters_.nee) {
                sum += beta *
                       next_event_->estimate(*hit, bsdf, rng, tracer, [this](double p, double p_l) {
                           return weight(kNextEvent, p, p_l);
                       });
            }

            // End long paths at random. The survival probability is in beta, not in the densities.
            if (depth >= parameters_.rr_depth) {
                const float survival = std::min(kMaxSurvival, max_channel(beta));
                if (rng.uniform() >= survival) return sum;
                beta = (1 / survival) * beta;
            }

            // Continue in a direction sampled from the BSDF.
            const float lobe = rng.uniform();
            const float u = rng.uniform();
            const auto sample = bsdf.sample({lobe, {u, rng.uniform()}});
            if (!sample) return sum;
            MISBENCH_CHECK(sample->pdf > 0);
            beta *= sample->weight;
            if (beta == Rgb{}) return sum;
            p_b = sample->pdf;
            previous = hit;
            ray = {hit->leave(sample->wi), sample->wi};
        }
    }

    PathParameters parameters_;
    Heuristic heuristic_;
    std::optional<NextEvent> next_event_;
};

}  // namespace

const MethodInfo kPath = method_info<PathTracer, PathParameters>(
    "path", "path tracing with next event estimation", 1, false);

}  // namespace misbench
