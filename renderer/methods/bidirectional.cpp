// [Vea97]   E. Veach, Robust Monte Carlo Methods for Light Transport Simulation, 1997.
// [PRDD15]  S. Popov, R. Ramamoorthi, F. Durand, G. Drettakis, Probabilistic connections for
//           bidirectional path tracing, 2015.
// [GKDS12]  I. Georgiev, J. Křivánek, T. Davidovič, P. Slusallek, Light transport simulation with
//           vertex connection and merging, 2012.
// [KZ11]    C. Knaus, M. Zwicker, Progressive photon mapping: a probabilistic approach, 2011.
//
// x_1 … x_k   the camera path's vertices; y_0 … y_j the light path's, y_0 on the light
// n           edges of the full path: k + j + 1 connected, k + j merged
// beta        ∏ f cosθ / p along a subpath, Russian roulette included
// C_i, L_i    densities of x_i from the camera's and from the light's side (path_densities.h)
//
// Every technique fills in those of C and L that depend on where the subpaths meet, two on each
// side; all others are known to the subpaths.
#include "renderer/methods/bidirectional.h"

#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "renderer/methods/bidirectional_walk.h"
#include "renderer/methods/light_paths.h"
#include "renderer/methods/pass_context.h"
#include "renderer/methods/roulette.h"
#include "renderer/methods/specialize.h"
#include "renderer/paths/photon_map.h"
#include "renderer/paths/step.h"

namespace misbench {
namespace {

constexpr std::int64_t kSplatChunkSize = 256;

class Bidirectional final : public Method {
 public:
    explicit Bidirectional(const BidirectionalOptions& options)
        : options_(options), weights_(options.weights, options.precision) {}

    bool attach(SampleObserver& observer) override {
        weights_.attach(observer);
        return true;
    }

    void start(const Scene& scene, FrameInfo frame) override {
        scene_ = &scene;
        const LightSelection& selection = find_light_selection(options_.light_selection);
        next_event_.emplace(scene, selection);
        light_paths_.emplace(scene, selection, *next_event_);
        // A light path's first vertex is the second to last of a full path.
        if ((options_.light || options_.connect || options_.merge) && options_.max_depth > 1) {
            n_light_paths_ = LightPaths::count(options_.light_paths, frame);
        }
        merges_ = options_.merge && n_light_paths_ > 0;
        goes_on_ = options_.hit || options_.shadow_rays > 0 || options_.connect || options_.merge;
        weights_.start(scene, frame);
    }

    Forgotten finish_pass(ThreadPool& threads) override { return weights_.finish_pass(threads); }
    std::int64_t n_precomputed_passes() const override { return weights_.n_precomputed_passes(); }
    bool is_training() const override { return weights_.is_training(); }
    bool learns() const override { return weights_.learns(); }
    std::vector<NamedImage> maps() const override { return weights_.maps(); }

    void pass(PassContext& context) override {
        weights_.start_pass();
        specialize(context.scene(), [&]<bool kPlain>() {
            light_paths_->trace<kPlain>(context, n_light_paths_,
                                        {options_.max_depth - 1, options_.rr_depth});
            if (!context.complete()) return;
            count_techniques();
            const std::int64_t i = context.is_precomputed() ? 1 : context.pass() + 1;
            shrink_ = std::pow(static_cast<double>(i), options_.radius_shrink - 1);
            if (counts_.light > 0) splat_light_paths<kPlain>(context);
            if (merges_) build_photon_map(context);
            estimate_pixels<kPlain>(context);
            if (counts_.light > 0) context.add_splats();
        });
    }

    void describe(nlohmann::json& json) const override {
        json["light_paths"] = n_light_paths_;
        json["light_vertices"] = light_paths_->vertices().size();  // of the last pass
        weights_.describe(json);
    }

 private:
    // n_t of every technique. A light vertex is drawn with probability 1 / N of the cache, which
    // holds the N vertices of n_light paths.                                          [PRDD15]
    void count_techniques() {
        const auto n_light = static_cast<double>(n_light_paths_);
        const auto n_cached = static_cast<double>(light_paths_->vertices().size());
        counts_ = {.hit = options_.hit ? 1.0 : 0.0,
                   .nee = static_cast<double>(options_.shadow_rays),
                   .light = options_.light ? n_light : 0,
                   .merge = options_.merge && !options_.merge_ends_path ? n_light : 0,
                   .split = static_cast<double>(options_.bsdf_samples),
                   .merge_first = options_.merge_first};
        if (options_.connect && n_cached > 0) {
            counts_.connect = options_.paired ? 1 : options_.connections * n_light / n_cached;
        }
    }

    // π r² for a camera ray of that length and density to x_1. It shrinks with the passes. [KZ11]
    double merge_area(Vec3 x_1, double distance, double pdf_direction) const {
        double unit = double{scene_->radius()};
        if (options_.radius_unit == RadiusUnit::Distance) unit = distance;
        if (options_.radius_unit == RadiusUnit::Footprint) {
            unit = distance / std::sqrt(pdf_direction);
        }
        const double radius = options_.radius_scale * unit;
        return std::max(M_PI * radius * radius * shrink_, smallest_merge_area(x_1));
    }

    bool has_light_paths() const { return n_light_paths_ > 0; }
    bool wants(std::int64_t n_edges) const {
        return n_edges >= options_.min_depth && n_edges <= options_.max_depth;
    }

    // Whether other techniques could have made such a path.
    bool has_alternatives(Technique technique) const {
        if (technique.kind == TechniqueKind::Merge) return !options_.merge_ends_path;
        return technique.kind != TechniqueKind::Light || goes_on_;
    }

    // The weighted contribution of one sample: scale · value is what it would be with weight 1.
    Rgb weighted(const PathView& path, Technique technique, Rgb value, double scale,
                 std::size_t chunk, Scratch& scratch) const {
        const double w = weights_.weigh(path, counts_, technique, has_alternatives(technique),
                                        value, scale, chunk, scratch.weights);
        return static_cast<float>(w * scale) * value;
    }
    void add(Walk& walk, std::span<const LightVertex> light, Technique technique, Rgb value,
             double scale) const {
        const PathView path{.densities = &walk.scratch.densities,
                            .pixel = walk.pixel,
                            .origin = walk.origin,
                            .camera = walk.scratch.camera,
                            .light = light};
        walk.sum += weighted(path, technique, value, scale, walk.chunk, walk.scratch);
    }

    // L_{k-1}: the density of x_{k-1} were x_k reached from direction w.
    template <class Bsdf>
    static void arrive_from(Scratch& scratch, const Bsdf& bsdf, Vec3 w) {
        const std::size_t k = scratch.camera.size();
        if (k < 2) return;
        scratch.densities.from_light[k - 1] = solid_angle_to_area(
            bsdf.reverse_pdf(w), scratch.camera[k - 1].point.position, scratch.camera[k - 2].point);
    }

    // ---- Light tracing: every vertex of a light path is connected to the camera.

    template <bool kPlain>
    void splat_light_paths(PassContext& context) {
        const std::size_t n_chunks = PassContext::n_chunks(n_light_paths_, kSplatChunkSize);
        weights_.start_phase(n_chunks);
        context.for_each_chunk(n_light_paths_, kSplatChunkSize, [&](PassContext::Chunk& chunk) {
            ScratchPool::Lease lease(scratch_);
            (*lease).camera.clear();
            for (std::int64_t i = chunk.begin; i < chunk.end; ++i) {
                Rng rng(context.seed(), static_cast<std::uint32_t>(i),
                        static_cast<std::uint32_t>(context.pass()), Stream::LensOfLightPath);
                const std::span<const LightVertex> path = light_paths_->path(i);
                for (std::size_t j = 1; j < path.size(); ++j) {
                    Vec2 lens;
                    if (context.camera().has_lens()) {
                        lens.x = rng.uniform();
                        lens.y = rng.uniform();
                    }
                    if (!path[j].has_smooth_lobes || !wants(std::int64_t(j) + 1)) continue;
                    const auto view = context.camera().view(path[j].point.position, lens);
                    if (view) splat<kPlain>(chunk, path.first(j + 1), *view, *lease);
                }
            }
        });
        weights_.finish_phase();
    }

    template <bool kPlain>
    void splat(PassContext::Chunk& chunk, std::span<const LightVertex> light,
               const Camera::View& view, Scratch& scratch) const {
        // Evaluate the way from y_j to the camera.
        const LightVertex& y = light.back();
        const BasicBsdf<!kPlain> bsdf(*scene_, y.point, y.wo, Transport::Importance);
        const BsdfValue f = bsdf.evaluate(-view.w);
        const bool carries = !(f.f_cos == Rgb{}) && chunk.tracer.visible(y.point, view.position);
        if (!carries && !weights_.wants_zeros()) return;

        // Put the full path together: x_1 is y_j.
        const auto j = light.size() - 1;
        PathDensities& d = scratch.densities;
        d.n_edges = static_cast<int>(j) + 1;
        d.make_room(d.n_edges);
        append_light(d, light, j);
        d.is_delta[1] = 0;
        d.from_camera[1] = solid_angle_to_area(view.importance, view.position, y.point);
        d.from_camera[2] =
            reverse_density(bsdf.reverse_pdf(-view.w), y.point.position, light[j - 1]);
        const double d2 = squared_length(y.point.position - view.position);
        d.merge_area = merge_area(y.point.position, std::sqrt(d2), view.importance);

        // Add what the pixel receives of the light that the path carries.
        const PathView path{.densities = &d,
                            .pixel = {static_cast<int>(view.film.x), static_cast<int>(view.film.y)},
                            .origin = view.position,
                            .light = light};
        const double scale = carries ? view.importance / (d2 * counts_.light) : 0;
        const Rgb value =
            weighted(path, {TechniqueKind::Light}, y.beta * f.f_cos, scale, chunk.index, scratch);
        if (!(value == Rgb{})) chunk.splat(path.pixel.x, path.pixel.y, value);
    }

    // ---- Camera paths.

    void build_photon_map(PassContext& context) {
        photon_positions_.clear();
        for (const LightVertex* vertex : light_paths_->vertices()) {
            photon_positions_.push_back(vertex->point.position);
        }
        photons_.build(photon_positions_, context.threads());
    }

    template <bool kPlain>
    void estimate_pixels(PassContext& context) {
        struct State {
            ScratchPool::Lease lease;
            std::size_t chunk;
        };
        weights_.start_phase(context.n_tiles());
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
                trace<kPlain>(
                    walk,
                    {.ray = sample.ray,
                     .pdf_direction = context.camera().pdf_direction(sample.ray.direction)},
                    1);
                return walk.sum;
            });
        weights_.finish_phase();
    }

    // Follows a camera path from edge k on.
    template <bool kPlain>
    void trace(Walk& walk, Leg leg, std::int64_t k) const {
        Scratch& scratch = walk.scratch;
        PathDensities& d = scratch.densities;
        for (;; ++k) {
            // Find x_k, or light from far outside.
            const auto i = static_cast<std::size_t>(k);
            d.make_room(static_cast<int>(k) + 1);
            scratch.camera.resize(i - 1);
            draw_connections(walk, k);
            const auto hit = walk.tracer.closest(leg.ray);
            if (!hit) {
                if constexpr (!kPlain) add_background(walk, leg, k);
                return;
            }
            const Vec3 wo = -leg.ray.direction;
            const Vec3 from = k == 1 ? leg.ray.origin : scratch.camera.back().point.position;
            d.from_camera[i] = solid_angle_to_area(leg.pdf_direction, from, *hit);
            scratch.camera.push_back({.point = *hit, .wo = wo, .beta = leg.beta});
            if (k == 1) {
                const double d2 = squared_length(hit->position - from);
                d.merge_area = merge_area(hit->position, std::sqrt(d2), leg.pdf_direction);
                walk.radius = static_cast<float>(std::sqrt(d.merge_area / M_PI));
            }
            if (const Rgb emitted = scene_->emitted(*hit, wo); !(emitted == Rgb{})) {
                add_hit(walk, emitted);
            }
            if (k == options_.max_depth || !goes_on_) return;

            // Join it with the light in all ways that end at x_k.
            const BasicBsdf<!kPlain> bsdf(*scene_, *hit, wo);
            d.is_delta[i] = 0;
            bool may_go_on = true;  // by more than delta lobes
            if (options_.merge_ends_path && (bsdf.lobes() & kDiffuseLobe) != 0) {
                merges(walk, bsdf);
                may_go_on = false;
            } else if (kPlain || (bsdf.lobes() & kSmoothLobes) != 0) {
                fetch_connections(scratch);
                next_events<kPlain>(walk, bsdf);
                connections<kPlain>(walk, bsdf);
                if (!options_.merge_ends_path) merges(walk, bsdf);
            }

            // Go on, at first in several directions.
            const std::int64_t n_samples = k == 1 ? options_.bsdf_samples : 1;
            for (std::int64_t s = 1; s < n_samples; ++s) {
                Leg branch = leg;
                if (extend(walk, branch, bsdf, k)) trace<kPlain>(walk, branch, k + 1);
                scratch.camera.resize(1);
            }
            if (!extend(walk, leg, bsdf, k) ||
                !(may_go_on || walk.scratch.camera.back().is_delta)) {
                return;
            }
        }
    }

    // Continues in a direction sampled from the BSDF at x_k. False: the path ends.
    template <class Bsdf>
    bool extend(Walk& walk, Leg& leg, const Bsdf& bsdf, std::int64_t k) const {
        PathVertex& x = walk.scratch.camera.back();
        // End long paths at random, by the throughput without the scale of refraction. The survival
        // probability is in beta, not in the densities.
        if (options_.rr_depth > 0 && k >= options_.rr_depth &&
            !survives(leg.eta * leg.eta * max_channel(leg.beta) * leg.n_shared, walk.rng,
                      leg.beta)) {
            return false;
        }
        const auto step = sample_step(bsdf, x.point, x.wo, walk.rng, has_light_paths());
        if (!step) return false;
        leg.beta *= step->weight;
        if (leg.beta == Rgb{}) return false;
        if (k == 1) {
            leg.n_shared = static_cast<float>(options_.bsdf_samples);
            leg.beta = (1 / leg.n_shared) * leg.beta;
        }
        leg.eta *= step->eta;
        leg.pdf_direction = step->pdf_forward;
        leg.ray = {x.point.leave(step->wi), step->wi};
        x.is_delta = step->is_delta;
        PathDensities& d = walk.scratch.densities;
        const auto i = static_cast<std::size_t>(k);
        d.is_delta[i] = step->is_delta ? 1 : 0;
        if (k > 1 && has_light_paths()) {
            d.from_light[i - 1] = solid_angle_to_area(step->pdf_reverse, x.point.position,
                                                      walk.scratch.camera[i - 2].point);
        }
        return true;
    }

    // ---- Hit: the camera path ran into light.

    void add_hit(Walk& walk, Rgb emitted) const {
        Scratch& scratch = walk.scratch;
        const PathVertex& x = scratch.camera.back();
        const std::size_t n = scratch.camera.size();
        PathDensities& d = scratch.densities;
        d.n_edges = static_cast<int>(n);
        if (!wants(d.n_edges) || (n > 1 && !options_.hit)) return;
        if (n > 1) {
            const SurfacePoint& before = scratch.camera[n - 2].point;
            d.next_event = next_event_->pdf_area(before.position, x.point);
            end_at_light(d, x.point.light, x.point, x.wo, before);
        }
        add(walk, {}, {TechniqueKind::Hit}, x.beta * emitted, 1);
    }

    void add_background(Walk& walk, const Leg& leg, std::int64_t k) const {
        const Rgb radiance = scene_->background(leg.ray.direction);
        if (radiance == Rgb{} || !wants(k) || (k > 1 && !options_.hit)) return;
        Scratch& scratch = walk.scratch;
        PathDensities& d = scratch.densities;
        d.n_edges = static_cast<int>(k);
        scratch.end = {};
        scratch.end.point.light = scene_->environment_light();
        scratch.end.wo = -leg.ray.direction;
        scratch.end.is_infinite = true;
        if (k > 1) {
            const SurfacePoint& before = scratch.camera.back().point;
            d.from_camera[static_cast<std::size_t>(k)] = leg.pdf_direction;
            d.next_event = next_event_->environment_pdf(before.position, leg.ray.direction);
            end_at_light(d, scratch.end.point.light, {}, scratch.end.wo, before);
        }
        add(walk, {&scratch.end, 1}, {TechniqueKind::Hit}, leg.beta * radiance, 1);
    }

    // L_n and L_{n-1} of light that leaves x_n in direction w.
    void end_at_light(PathDensities& d, std::uint32_t light, const SurfacePoint& point, Vec3 w,
                      const SurfacePoint& before) const {
        if (!has_light_paths()) return;
        const auto n = static_cast<std::size_t>(d.n_edges);
        const LightPaths::FirstEdge edge = light_paths_->first_edge(light, point, w, before);
        d.from_light[n] = edge.light;
        d.from_light[n - 1] = edge.to;
    }

    // ---- Next event estimation: x_n is sampled on a light, as seen from x_k.

    template <bool kPlain, class Bsdf>
    void next_events(Walk& walk, const Bsdf& bsdf) const {
        const auto k = walk.scratch.camera.size();
        if (!wants(static_cast<std::int64_t>(k) + 1)) return;
        for (std::int64_t s = 0; s < options_.shadow_rays; ++s) {
            add_next_event<kPlain>(walk, bsdf);
        }
    }

    template <bool kPlain, class Bsdf>
    void add_next_event(Walk& walk, const Bsdf& bsdf) const {
        Scratch& scratch = walk.scratch;
        const PathVertex& x = scratch.camera.back();
        const auto light = next_event_->sample<kPlain>(x.point, walk.rng);
        if (!light) return;
        const BsdfValue f = bsdf.evaluate(light->wi);
        const bool carries = !(f.f_cos == Rgb{}) && walk.tracer.visible<kPlain>(x.point, *light);
        if (!carries && !weights_.wants_zeros()) return;

        PathDensities& d = scratch.densities;
        const std::size_t n = scratch.camera.size() + 1;
        d.n_edges = static_cast<int>(n);
        if (light->is_delta || light->is_infinite) {
            d.from_camera[n] = light->is_delta ? 0 : f.pdf;
            d.next_event = light->pdf;
        } else {
            const double to_area = solid_angle_to_area(1, x.point.position, light->point);
            d.from_camera[n] = f.pdf * to_area;
            d.next_event = light->pdf * to_area;
        }
        if (has_light_paths()) {
            end_at_light(d, light->light, light->point, -light->wi, x.point);
            arrive_from(scratch, bsdf, light->wi);
        }
        scratch.end.point = light->point;
        scratch.end.point.light = light->light;
        scratch.end.wo = -light->wi;
        scratch.end.is_infinite = light->is_infinite;
        scratch.end.is_delta_light = light->is_delta;
        const double scale = carries ? 1 / (light->pdf * counts_.nee) : 0;
        add(walk, {&scratch.end, 1}, {TechniqueKind::NextEvent},
            x.beta * (f.f_cos * light->radiance), scale);
    }

    // ---- Connections: x_k with y_j.                                           [Vea97 §10.2]

    // Draws from the cache what x_k will be connected to, a fractional number of vertices rounded
    // at random. Memory is slow to find a random vertex: it is asked for it in two steps, early
    // enough to answer while rays are traced. [PRDD15]
    void draw_connections(Walk& walk, std::int64_t k) const {
        walk.scratch.drawn.clear();
        if (options_.paired || counts_.connect == 0 || k + 2 > options_.max_depth) return;
        auto n = static_cast<std::int64_t>(options_.connections);
        const double fraction = options_.connections - static_cast<double>(n);
        if (fraction > 0 && double{walk.rng.uniform()} < fraction) ++n;
        const auto vertices = light_paths_->vertices();
        for (std::int64_t i = 0; i < n; ++i) {
            double u = double{walk.rng.uniform()};
            u += 0x1p-24 * double{walk.rng.uniform()};
            const auto at = static_cast<std::size_t>(u * static_cast<double>(vertices.size()));
            walk.scratch.drawn.push_back(&vertices[at]);
            __builtin_prefetch(walk.scratch.drawn.back());
        }
    }
    static void fetch_connections(const Scratch& scratch) {
        for (const LightVertex* const* vertex : scratch.drawn) prefetch(**vertex);
    }

    template <bool kPlain, class Bsdf>
    void connections(Walk& walk, const Bsdf& bsdf) const {
        if (counts_.connect == 0) return;
        if (static_cast<std::int64_t>(walk.scratch.camera.size()) + 2 > options_.max_depth) return;
        if (options_.paired) {
            const auto path = light_paths_->path(walk.pixel_index % n_light_paths_);
            for (std::size_t j = 1; j < path.size(); ++j) {
                if (path[j].has_smooth_lobes) connect<kPlain>(walk, bsdf, path[j]);
            }
            return;
        }
        for (const LightVertex* const* vertex : walk.scratch.drawn) {
            connect<kPlain>(walk, bsdf, **vertex);
        }
    }

    template <bool kPlain, class Bsdf>
    void connect(Walk& walk, const Bsdf& bsdf, const LightVertex& y) const {
        Scratch& scratch = walk.scratch;
        const std::size_t k = scratch.camera.size();
        const std::size_t j = y.n_edges;
        if (!wants(static_cast<std::int64_t>(k + j) + 1)) return;

        // Evaluate the edge from x_k to y_j. Where both are at one place, other techniques have all
        // of the weight.
        const PathVertex& x = scratch.camera.back();
        const Vec3 edge = y.point.position - x.point.position;
        const double d2 = squared_length(edge);
        if (d2 == 0) return;
        const Vec3 w = static_cast<float>(1 / std::sqrt(d2)) * edge;
        const BsdfValue f_x = bsdf.evaluate(w);
        if (f_x.f_cos == Rgb{} && !weights_.wants_zeros()) return;
        const BasicBsdf<!kPlain> bsdf_y(*scene_, y.point, y.wo, Transport::Importance);
        const BsdfValue f_y = bsdf_y.evaluate(-w);
        const bool carries =
            !(f_x.f_cos == Rgb{}) && !(f_y.f_cos == Rgb{}) && walk.tracer.visible(x.point, y.point);
        if (!carries && !weights_.wants_zeros()) return;

        // Put the full path together: x_{k+1} is y_j.
        const std::span<const LightVertex> light = light_path_to(y);
        PathDensities& d = scratch.densities;
        d.n_edges = static_cast<int>(k + j) + 1;
        d.make_room(d.n_edges);
        append_light(d, light, j);
        d.is_delta[k + 1] = 0;
        d.from_camera[k + 1] = solid_angle_to_area(f_x.pdf, x.point.position, y.point);
        d.from_camera[k + 2] =
            reverse_density(bsdf_y.reverse_pdf(-w), y.point.position, light[j - 1]);
        d.from_light[k] = solid_angle_to_area(f_y.pdf, y.point.position, x.point);
        arrive_from(scratch, bsdf, w);
        const double scale = carries ? 1 / (d2 * counts_.connect) : 0;
        add(walk, light, {TechniqueKind::Connect, static_cast<int>(k)},
            (x.beta * f_x.f_cos) * (y.beta * f_y.f_cos), scale);
    }

    // ---- Merging: x_k with all y_j within the radius.                              [GKDS12]

    template <class Bsdf>
    void merges(Walk& walk, const Bsdf& bsdf) const {
        if (!merges_) return;
        const std::size_t k = walk.scratch.camera.size();
        if (k == 1 && !options_.merge_first) return;
        if (static_cast<std::int64_t>(k) + 1 > options_.max_depth) return;
        // As with connections, memory is asked in two steps for all that will be read.
        std::vector<FoundPhoton>& found = walk.scratch.found;
        found.clear();
        photons_.query(walk.scratch.camera.back().point.position, walk.radius,
                       [&](std::uint32_t photon, float distance2) {
                           found.push_back({&light_paths_->vertices()[photon], distance2});
                           __builtin_prefetch(found.back().vertex);
                       });
        for (const FoundPhoton& photon : found) prefetch(**photon.vertex);
        for (const FoundPhoton& photon : found) prefetch(*(*photon.vertex - 1));
        for (const FoundPhoton& photon : found) {
            merge(walk, bsdf, **photon.vertex, photon.distance2);
        }
    }

    template <class Bsdf>
    void merge(Walk& walk, const Bsdf& bsdf, const LightVertex& y, float distance2) const {
        Scratch& scratch = walk.scratch;
        const std::size_t k = scratch.camera.size();
        const std::size_t j = y.n_edges;
        if (!wants(static_cast<std::int64_t>(k + j))) return;

        // Scatter the photon's flux at x_k as if it had arrived there.
        const PathVertex& x = scratch.camera.back();
        const double cosine = std::abs(double{dot(x.point.normal, y.wo)});
        const BsdfValue f = bsdf.evaluate(y.wo);
        if (f.f_cos == Rgb{} || cosine == 0) return;

        // Put the full path together: x_k is y_j.
        const std::span<const LightVertex> light = light_path_to(y);
        PathDensities& d = scratch.densities;
        d.n_edges = static_cast<int>(k + j);
        d.make_room(d.n_edges);
        append_light(d, light, j - 1);
        d.from_light[k] = y.pdf_forward;
        d.from_camera[k + 1] = reverse_density(f.pdf, y.point.position, light[j - 1]);
        arrive_from(scratch, bsdf, y.wo);
        const double r2 = double{walk.radius} * double{walk.radius};
        double kernel = 1 / (M_PI * r2);
        if (options_.kernel == MergeKernel::Epanechnikov) {
            kernel *= 2 * (1 - double{distance2} / r2);
        }
        add(walk, light, {TechniqueKind::Merge, static_cast<int>(k)}, (x.beta * f.f_cos) * y.beta,
            kernel / (cosine * static_cast<double>(n_light_paths_)));
    }

    BidirectionalOptions options_;
    Weighting weights_;
    const Scene* scene_ = nullptr;
    std::int64_t n_light_paths_ = 0;
    bool merges_ = false;
    bool goes_on_ = false;  // some technique needs more of a camera path than its first vertex
    std::optional<NextEvent> next_event_;
    std::optional<LightPaths> light_paths_;
    PhotonMap photons_;
    std::vector<Vec3> photon_positions_;

    // Of the current pass.
    TechniqueCounts counts_;
    double shrink_ = 1;  // of the merge area

    ScratchPool scratch_;
};

}  // namespace

std::unique_ptr<Method> make_bidirectional(const BidirectionalOptions& options) {
    return std::make_unique<Bidirectional>(options);
}

}  // namespace misbench
