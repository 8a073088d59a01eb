// Direct light with n_l light samples and n_b BSDF samples at the first surface: the setting in
// which multiple importance sampling was proposed.
//
// [VG95]  E. Veach, L. J. Guibas, Optimally combining sampling techniques for Monte Carlo
//         rendering, 1995.
//
// p_b    density of a direction by BSDF sampling, solid angle measure
// p_l    density of the same direction by next event estimation, solid angle measure
#include "renderer/methods/direct.h"

#include <array>
#include <optional>

#include "renderer/methods/next_event.h"
#include "renderer/methods/parameters_of.h"
#include "renderer/methods/pass_context.h"
#include "renderer/methods/specialize.h"
#include "renderer/mis/heuristics.h"

namespace misbench {
namespace {

constexpr std::int64_t kMaxSamples = 1024;

struct DirectParameters {
    std::int64_t light_samples = 1;
    std::int64_t bsdf_samples = 1;
    std::string mis = "balance";
    std::string light_selection = "power";

    static void fields(auto& self, auto&& field) {
        field("light_samples", self.light_samples, "light samples a camera ray");
        field("bsdf_samples", self.bsdf_samples, "BSDF samples a camera ray");
        field("mis", self.mis, "heuristic that combines the two, where both are taken");
        field("light_selection", self.light_selection, "how one light is chosen among all");
    }

    void check() {
        for (const auto& [name, n] :
             {std::pair{"light_samples", light_samples}, std::pair{"bsdf_samples", bsdf_samples}}) {
            if (n < 0 || n > kMaxSamples) {
                throw ParameterError(name, std::string(name) + " must lie between 0 and " +
                                               std::to_string(kMaxSamples));
            }
        }
        if (light_samples + bsdf_samples == 0) {
            throw ParameterError("light_samples",
                                 "light_samples and bsdf_samples are both 0: nothing to do");
        }
        mis = Heuristic::parse(mis).canonical_name();
        find_light_selection(light_selection);
    }
};

class DirectLight final : public Method {
 public:
    explicit DirectLight(DirectParameters parameters)
        : parameters_(std::move(parameters)), heuristic_(Heuristic::parse(parameters_.mis)) {}

    void start(const Scene& scene, FrameInfo /*frame*/) override {
        next_event_.emplace(scene, find_light_selection(parameters_.light_selection));
    }

    void pass(PassContext& context) override {
        specialize(context.scene(), [&]<bool kPlain>() {
            context.for_each_pixel([this](const CameraSample& sample, Rng& rng, RayTracer& tracer) {
                return radiance<kPlain>(sample.ray, rng, tracer);
            });
        });
    }

 private:
    enum Technique : std::size_t { kBsdf, kNextEvent };

    template <bool kPlain>
    Rgb radiance(const Ray& ray, Rng& rng, RayTracer& tracer) const {
        const Scene& scene = tracer.scene();
        const std::optional<SurfacePoint> hit = tracer.closest(ray);
        if (!hit) return kPlain ? Rgb{} : scene.background(ray.direction);
        const Vec3 wo = -ray.direction;
        const BasicBsdf<!kPlain> bsdf(scene, *hit, wo);
        Rgb sum = scene.emitted(*hit, wo);
        for (std::int64_t i = 0; i < parameters_.light_samples; ++i) {
            sum += next_event_->template estimate<kPlain>(
                *hit, bsdf, rng, tracer,
                [this](double p_b, double p_l) { return weight(kNextEvent, p_b, p_l); },
                1 / static_cast<double>(parameters_.light_samples));
        }
        for (std::int64_t i = 0; i < parameters_.bsdf_samples; ++i) {
            sum += bsdf_sample<kPlain>(*hit, bsdf, rng, tracer);
        }
        return sum;
    }

    // w_s / n_s of one sample: the multi-sample estimator Σ_s 1/n_s Σ_i w_s f / p_s.  [VG95]
    double weight(Technique technique, double p_b, double p_l) const {
        const std::array n = {static_cast<double>(parameters_.bsdf_samples),
                              static_cast<double>(parameters_.light_samples)};
        const std::array q = {n[kBsdf] * p_b, n[kNextEvent] * p_l};
        return heuristic_.weight(q, technique) / n[technique];
    }

    template <bool kPlain>
    Rgb bsdf_sample(const SurfacePoint& point, const BasicBsdf<!kPlain>& bsdf, Rng& rng,
                    RayTracer& tracer) const {
        const float lobe = rng.uniform();
        const float u = rng.uniform();
        const auto sample = bsdf.sample({lobe, {u, rng.uniform()}});
        if (!sample) return {};
        const Scene& scene = tracer.scene();
        const auto hit = tracer.closest({point.leave(sample->wi), sample->wi});
        Rgb arriving;
        if (hit) arriving = scene.emitted(*hit, -sample->wi);
        if (!kPlain && !hit) arriving = scene.background(sample->wi);
        if (arriving == Rgb{}) return {};
        // Nothing else finds what a delta lobe sees.
        double w = 1 / static_cast<double>(parameters_.bsdf_samples);
        if (kPlain || !sample->is_delta) {
            w = weight(kBsdf, sample->pdf,
                       hit ? next_event_->pdf(point.position, *hit)
                           : next_event_->environment_pdf(point.position, sample->wi));
        }
        return static_cast<float>(w) * (sample->weight * arriving);
    }

    DirectParameters parameters_;
    Heuristic heuristic_;
    std::optional<NextEvent> next_event_;
};

std::string limits(const SceneFeatures& scene) {
    std::string text = "estimates emission and direct light only";
    if (scene.transmission) text += "; of what lies behind transparent surfaces, the emission only";
    if (scene.delta_lobes) text += "; with bsdf_samples=0 no light through delta lobes";
    if (scene.delta_lights) {
        text += "; with light_samples=0 no light of point, spot and directional lights";
    }
    return text;
}

}  // namespace

const MethodInfo kDirect = method_info_of<DirectLight, DirectParameters>(
    "direct", "emission and direct light by light samples and BSDF samples", 2, false, limits);

}  // namespace misbench
