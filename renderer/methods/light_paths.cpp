#include "renderer/methods/light_paths.h"

#include <fmt/format.h>

#include "renderer/base/error.h"
#include "renderer/methods/roulette.h"
#include "renderer/paths/step.h"

namespace misbench {
namespace {

constexpr std::int64_t kChunkSize = 256;

const LightSelection& emission_selection(const LightSelection& selection) {
    return selection.name == "tree" ? find_light_selection("power") : selection;
}

}  // namespace

double reverse_density(double pdf, Vec3 from, const LightVertex& to) {
    if (to.is_delta_light) return 0;
    return to.is_infinite ? pdf : solid_angle_to_area(pdf, from, to.point);
}

LightPaths::LightPaths(const Scene& scene, const LightSelection& selection,
                       const NextEvent& next_event)
    : scene_(scene),
      next_event_(next_event),
      sampler_(light_bounds(scene), emission_selection(selection)) {}

std::int64_t LightPaths::count(double per_pixel, FrameInfo frame) {
    constexpr double kMax = 1e9;  // far beyond memory; random numbers count to 2³²
    const double n = per_pixel * frame.width * frame.height;
    if (n > kMax) {
        throw Error(Errc::InvalidArgument,
                    fmt::format("light_paths={} of {}x{} pixels: more than {:.0f} paths", per_pixel,
                                frame.width, frame.height, kMax));
    }
    return std::llround(n);
}

LightPaths::FirstEdge LightPaths::first_edge(std::uint32_t light, const SurfacePoint& point, Vec3 w,
                                             const SurfacePoint& to) const {
    const double probability = sampler_.probability(light, {});
    const EmissionPdf pdf = emission_pdf(scene_, light, point, w);
    if (scene_.lights()[light].is_infinite()) {
        return {.light = probability * pdf.direction,
                .to = pdf.position * std::abs(double{dot(to.normal, w)})};
    }
    return {.light = probability * pdf.position,
            .to = solid_angle_to_area(pdf.direction, point.position, to)};
}

double LightPaths::next_event_density(const LightVertex& light, Vec3 from) const {
    if (light.is_delta_light) return next_event_.probability(from, light.point.light);
    if (light.is_infinite) return next_event_.environment_pdf(from, -light.wo);
    return next_event_.pdf_area(from, light.point);
}

template <bool kPlain>
void LightPaths::trace_path(Rng& rng, RayTracer& tracer, const Limits& limits,
                            std::vector<LightVertex>& vertices) const {
    // Choose a light, a point and a direction.
    double select = double{rng.uniform()};
    select += 0x1p-24 * double{rng.uniform()};
    const auto choice = sampler_.select({}, select);
    if (!choice) return;
    const Light& light = scene_.lights()[choice->light];
    const float u = rng.uniform();
    const Vec2 position = {u, rng.uniform()};
    LightRandom direction;
    direction.u.x = rng.uniform();
    direction.u.y = rng.uniform();
    if (needs_finer(light)) {
        direction.finer.x = rng.uniform();
        direction.finer.y = rng.uniform();
    }
    const auto start = sample_emission(scene_, choice->light, position, direction);
    if (!start) return;
    const double pdf = choice->probability * start->pdf_position * start->pdf_direction;
    const double cosine = std::abs(double{dot(start->point.normal, start->w)});
    Rgb beta = static_cast<float>(cosine / pdf) * start->emission;

    LightVertex first;
    first.point = start->point;
    first.wo = start->w;
    first.beta = beta;
    first.is_infinite = light.is_infinite();
    first.is_delta_light = light.is_delta();
    vertices.push_back(first);

    const float first_beta = max_channel(beta);
    Ray ray = {light.is_surface() ? start->point.leave(start->w) : start->point.position, start->w};
    double pdf_forward = start->pdf_direction;
    for (std::int64_t depth = 1;; ++depth) {
        // Find the vertex at the end of edge `depth`.
        const auto hit = tracer.closest(ray);
        if (!hit) return;
        LightVertex vertex;
        vertex.point = *hit;
        vertex.wo = -ray.direction;
        vertex.beta = beta;
        vertex.n_edges = static_cast<std::uint32_t>(depth);
        LightVertex& previous = vertices.back();
        if (depth == 1) {
            const FirstEdge edge = first_edge(choice->light, start->point, start->w, vertex.point);
            previous.pdf_forward = edge.light;
            vertex.pdf_forward = edge.to;
            vertex.next_event = next_event_density(previous, vertex.point.position);
        } else {
            vertex.pdf_forward =
                solid_angle_to_area(pdf_forward, previous.point.position, vertex.point);
        }
        const BasicBsdf<!kPlain> bsdf(scene_, vertex.point, vertex.wo, Transport::Importance);
        vertex.has_smooth_lobes = kPlain || (bsdf.lobes() & kSmoothLobes) != 0;
        vertices.push_back(vertex);
        if (depth == limits.max_edges) return;

        // End long paths at random, by what they still carry.
        if (limits.rr_depth > 0 && depth >= limits.rr_depth &&
            !survives(max_channel(beta) / first_beta, rng, beta)) {
            return;
        }

        // Continue in a direction sampled from the BSDF.
        const auto step = sample_step(bsdf, vertices.back().point, vertex.wo, rng, true);
        if (!step) return;
        beta *= step->weight;
        if (beta == Rgb{}) return;
        vertices.back().is_delta = step->is_delta;
        LightVertex& before = vertices[vertices.size() - 2];
        before.pdf_reverse = reverse_density(step->pdf_reverse, vertex.point.position, before);
        pdf_forward = step->pdf_forward;
        ray = {vertex.point.leave(step->wi), step->wi};
    }
}

template <bool kPlain>
void LightPaths::trace(PassContext& context, std::int64_t n_paths, const Limits& limits) {
    const std::size_t n_chunks = PassContext::n_chunks(n_paths, kChunkSize);
    if (chunks_.size() < n_chunks) {
        chunks_.resize(n_chunks);
        path_ends_.resize(n_chunks);
    }
    context.for_each_chunk(n_paths, kChunkSize, [&](PassContext::Chunk& chunk) {
        std::vector<LightVertex>& vertices = chunks_[chunk.index];
        std::vector<std::uint32_t>& ends = path_ends_[chunk.index];
        vertices.clear();
        ends.clear();
        for (std::int64_t i = chunk.begin; i < chunk.end; ++i) {
            Rng rng(context.seed(), static_cast<std::uint32_t>(i),
                    static_cast<std::uint32_t>(context.pass()), Stream::LightPath);
            trace_path<kPlain>(rng, chunk.tracer, limits, vertices);
            ends.push_back(static_cast<std::uint32_t>(vertices.size()));
        }
    });
    paths_.clear();
    vertices_.clear();
    if (!context.complete()) return;
    for (std::size_t c = 0; c < n_chunks; ++c) {
        std::uint32_t begin = 0;
        for (const std::uint32_t end : path_ends_[c]) {
            paths_.emplace_back(chunks_[c].data() + begin, end - begin);
            for (std::uint32_t i = begin + 1; i < end; ++i) {
                if (chunks_[c][i].has_smooth_lobes) vertices_.push_back(&chunks_[c][i]);
            }
            begin = end;
        }
    }
}

template void LightPaths::trace<true>(PassContext&, std::int64_t, const Limits&);
template void LightPaths::trace<false>(PassContext&, std::int64_t, const Limits&);

}  // namespace misbench
