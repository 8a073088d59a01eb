// Direct light with n_l light samples and n_b BSDF samples at the first surface: the setting in
// which multiple importance sampling was proposed [VG95]. A light sample may be one of several
// candidates: resampled importance sampling [TCE05], as in hua2025 section 6.
//
// [VG95]   E. Veach, L. J. Guibas, Optimally combining sampling techniques for Monte Carlo
//          rendering, 1995.
// [TCE05]  J. Talbot, D. Cline, P. Egbert, Importance resampling for global illumination, 2005.
// [NID20]  K. Nabata, K. Iwasaki, Y. Dobashi, Resampling-aware weighting functions for
//          bidirectional path tracing using multiple light sub-paths, 2020.
//
// x_1   the first surface; x_2 on a light, or a direction in which light is infinitely far
// q     density of a candidate x_2, by next event estimation
// p*    the target: unoccluded Le f cosθ, the mean of three channels; in area measure it is
//       hua2025 Eq. 25
// P     ∫ p*, as far as earlier passes know it: the pixel's mean of Σ p* / q over the candidates
// p_nee  what weights take for the density of a survivor
#include "renderer/methods/direct.h"

#include <array>
#include <nlohmann/json.hpp>
#include <optional>

#include "renderer/base/names.h"
#include "renderer/methods/bidirectional_walk.h"
#include "renderer/methods/next_event.h"
#include "renderer/methods/parameters_of.h"
#include "renderer/methods/pass_context.h"
#include "renderer/methods/resampling.h"
#include "renderer/methods/specialize.h"
#include "renderer/paths/step.h"
#include "renderer/weights/weighting.h"

namespace misbench {
namespace {

constexpr std::int64_t kMaxSamples = 1024;

struct ResampledDensity {
    std::string_view name;
    bool is_nabata;
};
constexpr std::array kResampledDensities{ResampledDensity{"candidate", false},
                                         ResampledDensity{"nabata", true}};
const ResampledDensity& find_resampled_density(const std::string& name) {
    return find_named(kResampledDensities, name, "resampled_density", "resampled density");
}

struct DirectParameters {
    std::int64_t light_samples = 1;
    std::int64_t bsdf_samples = 1;
    std::int64_t candidates = 1;
    std::string resampled_density = "candidate";
    bool nabata_keep = true;
    std::string light_selection = "power";
    WeightParameters weights = {};

    static void fields(auto& self, auto&& field) {
        field("light_samples", self.light_samples, "light samples a camera ray");
        field("bsdf_samples", self.bsdf_samples, "BSDF samples a camera ray");
        field("candidates", self.candidates,
              "candidates of which each light sample is resampled, by their unoccluded light; 1: "
              "plain next event estimation");
        field("resampled_density", self.resampled_density,
              "density of resampled light samples that weights use: candidate (of one candidate), "
              "nabata (with the normalization that earlier passes found, precomputed ones too; "
              "candidate in the first)");
        field("nabata_keep", self.nabata_keep,
              "the image keeps the samples of the first pass, in which nothing was known");
        field("light_selection", self.light_selection,
              "how one light is chosen among all; area: uniform over all surfaces that emit");
        WeightParameters::fields(self.weights, field);
    }

    void check() {
        check_range("light_samples", light_samples, std::int64_t{0}, kMaxSamples);
        check_range("bsdf_samples", bsdf_samples, std::int64_t{0}, kMaxSamples);
        check_range("candidates", candidates, std::int64_t{1}, kMaxSamples);
        if (light_samples + bsdf_samples == 0) {
            throw ParameterError("light_samples",
                                 "light_samples and bsdf_samples are both 0: nothing to do");
        }
        find_resampled_density(resampled_density);
        find_light_selection(light_selection);
        weights.check();
    }
};

double target_of(Rgb light) { return (double{light.r} + double{light.g} + double{light.b}) / 3; }

class DirectLight final : public Method {
 public:
    explicit DirectLight(const DirectParameters& parameters)
        : parameters_(parameters),
          n_candidates_(static_cast<double>(parameters.candidates)),
          is_nabata_(parameters.candidates > 1 &&
                     find_resampled_density(parameters.resampled_density).is_nabata),
          weights_(parameters.weights),
          counts_{.hit = static_cast<double>(parameters.bsdf_samples),
                  .nee = static_cast<double>(parameters.light_samples)} {}

    bool attach(SampleObserver& observer) override {
        weights_.attach(observer);
        return true;
    }

    void start(const Scene& scene, FrameInfo frame) override {
        scene_ = &scene;
        frame_ = frame;
        next_event_.emplace(scene, find_light_selection(parameters_.light_selection));
        if (is_nabata_) normalizations_.resize(Image(frame.width, frame.height).n_pixels());
        weights_.start(scene, frame);
    }

    void pass(PassContext& context) override {
        struct State {
            ScratchPool::Lease lease;
            std::size_t chunk;
        };
        weights_.start_pass(!learns_normalization_alone());
        weights_.start_phase(context.n_tiles());
        specialize(context.scene(), [&]<bool kPlain>() {
            context.for_each_pixel(
                [this](std::size_t chunk) {
                    return State{ScratchPool::Lease(scratch_), chunk};
                },
                [&](State& state, const CameraSample& sample, Rng& rng, RayTracer& tracer) {
                    Walk walk{.pixel = {sample.x, sample.y},
                              .pixel_index = sample.pixel,
                              .chunk = state.chunk,
                              .rng = rng,
                              .tracer = tracer,
                              .scratch = *state.lease,
                              .origin = sample.ray.origin};
                    estimate<kPlain>(walk, sample.ray,
                                     context.camera().pdf_direction(sample.ray.direction));
                    return walk.sum;
                });
        });
        weights_.finish_phase();
    }

    // Factors are learned on top of P, from the passes after those that are the first to know it.
    Forgotten finish_pass(ThreadPool& threads) override {
        const bool trained = !learns_normalization_alone();
        ++n_passes_;
        if (trained) return weights_.finish_pass(threads);
        return {.all = !parameters_.nabata_keep && !learns_normalization_alone()};
    }
    std::int64_t n_precomputed_passes() const override {
        const std::int64_t of_normalization = is_nabata_ ? parameters_.weights.precompute : 0;
        return of_normalization + weights_.n_precomputed_passes();
    }
    bool is_training() const override {
        return learns_normalization_alone() || weights_.is_training();
    }
    bool learns() const override { return is_nabata_ || weights_.learns(); }
    void describe(nlohmann::json& json) const override { weights_.describe(json); }

    std::vector<NamedImage> maps() const override {
        std::vector<NamedImage> maps = weights_.maps();
        if (!is_nabata_) return maps;
        NamedImage map{.name = "nabata.normalization", .image = Image(frame_.width, frame_.height)};
        for (std::size_t i = 0; i < map.image.rgb.size(); ++i) {
            map.image.rgb[i] = static_cast<float>(normalizations_[i / 3].mean());
        }
        maps.push_back(std::move(map));
        return maps;
    }

 private:
    // P of one pixel.
    struct Normalization {
        double sum = 0;
        double n = 0;  // of light samples
        double mean() const { return n > 0 ? sum / n : 0; }
    };

    bool learns_normalization_alone() const {
        constexpr std::int64_t kOnTheFly = 1;
        const std::int64_t precomputed = parameters_.weights.precompute;
        return is_nabata_ && n_passes_ < (precomputed > 0 ? precomputed : kOnTheFly);
    }

    template <bool kPlain>
    void estimate(Walk& walk, const Ray& ray, double pdf_direction) {
        // Find x_1, or light from far outside.
        Scratch& scratch = walk.scratch;
        PathDensities& d = scratch.densities;
        d.make_room(2);
        d.n_edges = 1;
        scratch.camera.clear();
        const std::optional<SurfacePoint> hit = walk.tracer.closest(ray);
        if (!hit) {
            if constexpr (!kPlain) {
                add_background(walk, ray.direction, scene_->background(ray.direction), 1);
            }
            return;
        }
        const Vec3 wo = -ray.direction;
        d.from_camera[1] = solid_angle_to_area(pdf_direction, ray.origin, *hit);
        scratch.camera.push_back({.point = *hit, .wo = wo, .beta = kWhite});
        if (const Rgb emitted = scene_->emitted(*hit, wo); !(emitted == Rgb{})) {
            add(walk, {}, TechniqueKind::Hit, emitted, 1);
        }

        // Add direct light by both techniques.
        d.n_edges = 2;
        const BasicBsdf<!kPlain> bsdf(*scene_, *hit, wo);
        Normalization here;
        const double known = is_nabata_ ? normalizations_[walk.pixel_index].mean() : 0;
        for (std::int64_t i = 0; i < parameters_.light_samples; ++i) {
            here.sum += add_next_event<kPlain>(walk, bsdf, known);
            ++here.n;
        }
        for (std::int64_t i = 0; i < parameters_.bsdf_samples; ++i) {
            add_bsdf_sample<kPlain>(walk, bsdf, known);
        }
        if (is_nabata_) {
            normalizations_[walk.pixel_index].sum += here.sum;
            normalizations_[walk.pixel_index].n += here.n;
        }
    }

    void add(Walk& walk, std::span<const LightVertex> light, TechniqueKind technique, Rgb value,
             double scale) const {
        const PathView path{.densities = &walk.scratch.densities,
                            .pixel = walk.pixel,
                            .origin = walk.origin,
                            .camera = walk.scratch.camera,
                            .light = light};
        const bool has_alternatives = path.n_edges() == 2 && counts_.hit > 0 && counts_.nee > 0;
        const double w = weights_.weigh(path, counts_, {technique}, has_alternatives, value, scale,
                                        walk.chunk, walk.scratch.weights);
        walk.sum += static_cast<float>(w * scale) * value;
    }

    // p_nee, in the measure of q and p*.
    double density(double q, double target, double normalization) const {
        return normalization > 0 ? resampled_density(q, target, normalization, n_candidates_) : q;
    }

    // ---- Next event estimation. Returns what its candidates say of P.

    template <bool kPlain, class Bsdf>
    double add_next_event(Walk& walk, const Bsdf& bsdf, double normalization) const {
        // Draw candidates, of which one survives; only that one's visibility is tested.    [TCE05]
        Scratch& scratch = walk.scratch;
        const SurfacePoint& x = scratch.camera.front().point;
        Reservoir reservoir;
        std::optional<LightEnd> survivor;
        BsdfValue f;
        for (std::int64_t i = 0; i < parameters_.candidates; ++i) {
            const auto drawn = next_event_->template sample<kPlain>(x, walk.rng);
            if (!drawn) continue;
            const BsdfValue value = bsdf.evaluate(drawn->wi);
            if (reservoir.keeps(target_of(value.f_cos * drawn->radiance) / drawn->pdf, walk.rng)) {
                survivor = drawn;
                f = value;
            }
        }
        const double estimate = reservoir.weight_sum() / n_candidates_;
        if (!survivor) return estimate;
        const LightEnd& light = *survivor;
        const Rgb value = f.f_cos * light.radiance;
        const bool carries = !(value == Rgb{}) && walk.tracer.visible<kPlain>(x, light);
        if (!carries && !weights_.wants_zeros()) return estimate;

        // Put the full path together.
        PathDensities& d = scratch.densities;
        const bool on_surface = !light.is_delta && !light.is_infinite;
        const double measure = on_surface ? solid_angle_to_area(1, x.position, light.point) : 1;
        const double target = target_of(value);
        d.is_delta[1] = 0;
        d.from_camera[2] = light.is_delta ? 0 : f.pdf * measure;
        d.next_event = density(light.pdf * measure, target * measure, normalization);
        scratch.camera.front().is_delta = false;
        scratch.end.point = light.point;
        scratch.end.point.light = light.light;
        scratch.end.wo = -light.wi;
        scratch.end.is_infinite = light.is_infinite;
        scratch.end.is_delta_light = light.is_delta;
        add(walk, {&scratch.end, 1}, TechniqueKind::NextEvent, value,
            carries ? estimate / (target * counts_.nee) : 0);
        return estimate;
    }

    // ---- BSDF sampling.

    template <bool kPlain, class Bsdf>
    void add_bsdf_sample(Walk& walk, const Bsdf& bsdf, double normalization) const {
        Scratch& scratch = walk.scratch;
        PathVertex& x = scratch.camera.front();
        const auto step = sample_step(bsdf, x.point, x.wo, walk.rng, /*wants_reverse=*/false);
        if (!step) return;
        const auto hit = walk.tracer.closest({x.point.leave(step->wi), step->wi});
        Rgb arriving;
        if (hit) arriving = scene_->emitted(*hit, -step->wi);
        if (!kPlain && !hit) arriving = scene_->background(step->wi);
        if (arriving == Rgb{}) return;

        // Put the full path together, with p_nee as next event estimation would find it.
        PathDensities& d = scratch.densities;
        x.is_delta = step->is_delta;
        d.is_delta[1] = step->is_delta ? 1 : 0;
        const double measure = hit ? solid_angle_to_area(1, x.point.position, *hit) : 1;
        d.from_camera[2] = step->pdf_forward * measure;
        d.next_event = hit ? next_event_->pdf_area(x.point.position, *hit)
                           : next_event_->environment_pdf(x.point.position, step->wi);
        if (normalization > 0) {
            const double target = target_of(bsdf.evaluate(step->wi).f_cos * arriving);
            d.next_event = density(d.next_event, target * measure, normalization);
        }
        const Rgb value = step->weight * arriving;
        if (hit) {
            scratch.camera.push_back({.point = *hit,
                                      .wo = -step->wi,
                                      .beta = static_cast<float>(1 / counts_.hit) * step->weight});
            add(walk, {}, TechniqueKind::Hit, value, 1 / counts_.hit);
            scratch.camera.pop_back();
        } else {
            add_background(walk, step->wi, value, 1 / counts_.hit);
        }
    }

    // Light from far outside that a ray in direction w found.
    void add_background(Walk& walk, Vec3 w, Rgb value, double scale) const {
        if (value == Rgb{}) return;
        LightVertex& end = walk.scratch.end;
        end = {};
        end.point.light = scene_->environment_light();
        end.wo = -w;
        end.is_infinite = true;
        add(walk, {&end, 1}, TechniqueKind::Hit, value, scale);
    }

    DirectParameters parameters_;
    double n_candidates_;
    bool is_nabata_;
    Weighting weights_;
    TechniqueCounts counts_;
    const Scene* scene_ = nullptr;
    FrameInfo frame_{};
    std::optional<NextEvent> next_event_;
    std::vector<Normalization> normalizations_;  // by pixel
    std::int64_t n_passes_ = 0;                  // done
    ScratchPool scratch_;
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
    "direct", "emission and direct light by light samples, resampled or not, and BSDF samples", 3,
    false, limits);

}  // namespace misbench
