#include "tests/support/path_oracle.h"

#include <cmath>

#include "renderer/scene/bsdf.h"
#include "renderer/scene/light_transport.h"

namespace misbench::test {
namespace {

struct Double3 {
    double x, y, z;
    explicit Double3(Vec3 v) : x(double{v.x}), y(double{v.y}), z(double{v.z}) {}
};
double exact_dot(Vec3 a, Vec3 b) {
    const Double3 u(a);
    const Double3 v(b);
    return u.x * v.x + u.y * v.y + u.z * v.z;
}
double abs_cos(Vec3 normal, Vec3 w) { return std::abs(exact_dot(normal, w)); }

// From a to b.
struct Edge {
    Vec3 direction;
    double length2 = 0;
};
Edge edge_between(Vec3 a, Vec3 b) {
    const Double3 from(a);
    const Double3 to(b);
    const double x = to.x - from.x;
    const double y = to.y - from.y;
    const double z = to.z - from.z;
    const double length2 = x * x + y * y + z * z;
    const double scale = 1 / std::sqrt(length2);
    return {{static_cast<float>(scale * x), static_cast<float>(scale * y),
             static_cast<float>(scale * z)},
            length2};
}

constexpr double kUnitRounding = 0x1p-23;

double distance(Vec3 a, Vec3 b) { return std::sqrt(edge_between(a, b).length2); }

// The i-th number in [0, 1) of van der Corput's sequence: large lobes are met soon.
float radical_inverse(std::uint32_t i) {
    std::uint32_t reversed = 0;
    for (int bit = 0; bit < 24; ++bit) reversed |= (i >> bit & 1U) << (23 - bit);
    return static_cast<float>(reversed) * 0x1p-24F;
}

std::optional<BsdfSample> find_delta_lobe(const Bsdf& bsdf, Vec3 wi) {
    constexpr std::uint32_t kTries = 1U << 18;
    constexpr double kSameDirection = 1e-3;
    for (std::uint32_t i = 0; i < kTries; ++i) {
        const auto sample = bsdf.sample({radical_inverse(i), {0.5F, 0.5F}});
        if (sample && sample->is_delta && distance(sample->wi, wi) < kSameDirection) return sample;
    }
    return std::nullopt;
}

// One direction of a vertex: of going on to wi from wo.
struct Way {
    double pdf = 0;
    std::array<double, 3> f_cos_cos{};
};
std::optional<Way> way(const Scene& scene, const SurfacePoint& point, bool is_delta, Vec3 wo,
                       Vec3 wi, Transport transport) {
    const Bsdf bsdf(scene, point, wo, transport);
    Way way;
    Rgb f_cos;
    double scale = abs_cos(point.normal, wo);
    if (is_delta) {
        const auto lobe = find_delta_lobe(bsdf, wi);
        if (!lobe) return std::nullopt;
        way.pdf = lobe->pdf * double{lobe->eta} *
                  std::sqrt(abs_cos(point.shading_normal, wi) / abs_cos(point.shading_normal, wo));
        f_cos = lobe->weight;
        scale *= way.pdf;
    } else {
        const BsdfValue value = bsdf.evaluate(wi);
        way.pdf = value.pdf;
        f_cos = value.f_cos;
    }
    way.f_cos_cos = {scale * double{f_cos.r}, scale * double{f_cos.g}, scale * double{f_cos.b}};
    return way;
}

// Where the light's subpath is joined, the light path may have gone on by a delta lobe; the full
// path does not.
bool scatters_by_delta(const PathView& path, int i) {
    const bool is_joint = i == path.n_edges() - static_cast<int>(path.light.size()) + 1;
    return path.vertex(i).is_delta && !is_joint;
}

}  // namespace

struct PathOracle::Geometry {
    std::vector<Edge> edges;  // x_i to x_{i+1} at i
    bool is_infinite = false;
    double direction_error = 0;
    double rounding = 0;

    // A direction that is wrong by `error` makes its cosine wrong by so much, relative. Points in
    // space have no cosine.
    void note_rounding(const SurfacePoint& point, Vec3 w, double error) {
        if (point.material != nullptr) {
            rounding = std::max(rounding, error / abs_cos(point.normal, w));
        }
    }
    const Edge& edge(int i) const { return edges[static_cast<std::size_t>(i)]; }
    // From solid angle measure at the one end of an edge to area measure at the other.
    double to_area(int i, const SurfacePoint& at) const {
        return abs_cos(at.normal, edge(i).direction) / edge(i).length2;
    }
};

PathOracle::PathOracle(const Scene& scene, int width, int height,
                       const std::string& light_selection)
    : scene_(scene),
      camera_(scene.camera(), width, height),
      next_event_(light_bounds(scene), find_light_selection(light_selection)) {
    std::vector<double> weights;
    for (const LightBounds& light : light_bounds(scene)) {
        weights.push_back(light_selection == "uniform" ? 1 : light.power);
    }
    emission_choice_ = DiscreteDistribution(weights);
}

// Where a subpath knows the direction of an edge, that is taken: a narrow lobe tells it from the
// one between two rounded positions.
PathOracle::Geometry PathOracle::geometry_of(const PathView& path) const {
    const int n = path.n_edges();
    const int n_camera = static_cast<int>(path.camera.size());
    const int n_light = static_cast<int>(path.light.size());
    Geometry geometry;
    geometry.is_infinite = scene_.lights()[path.vertex(n).point.light].is_infinite();

    Vec3 lens_point = scene_.camera().to_world.translation();
    if (camera_.has_lens()) {
        const auto& rows = scene_.camera().to_world.rows;
        const Vec3 axis = {rows[0][2], rows[1][2], rows[2][2]};
        const PathVertex& first = path.vertex(1);
        const bool escapes = n == 1 && geometry.is_infinite;
        if (!escapes) {
            const float t = dot(lens_point - first.point.position, axis) / dot(first.wo, axis);
            lens_point = first.point.position + t * first.wo;
        }
    }
    for (int i = 0; i < n; ++i) {
        std::optional<Vec3> known;
        if (i + 1 <= n_camera) {
            known = -path.vertex(i + 1).wo;
        } else if (n - i < n_light) {
            known = path.light[static_cast<std::size_t>(n - i)].wo;
        } else if (geometry.is_infinite && i == n - 1) {
            known = -path.vertex(n).wo;
        }
        if (geometry.is_infinite && i == n - 1) {
            if (i > 0) geometry.note_rounding(path.vertex(i).point, *known, kUnitRounding);
            geometry.edges.push_back({*known, 1});
            continue;
        }
        const SurfacePoint& to = path.vertex(i + 1).point;
        Vec3 from = i == 0 ? lens_point : path.vertex(i).point.position;
        // A photon came to its own place, beside that of the vertex that it is merged with.
        if (i > 0 && n - i < n_light) {
            from = path.light[static_cast<std::size_t>(n - i)].point.position;
        }
        Edge edge = edge_between(from, to.position);
        const double d = std::sqrt(edge.length2);
        double error =
            kUnitRounding + kUnitRounding * double{max_abs(from) + max_abs(to.position)} / d;
        if (known) {
            const double offsets =
                double{to.offset} + (i == 0 ? 0 : double{path.vertex(i).point.offset});
            const double difference = distance(*known, edge.direction);
            geometry.direction_error =
                std::max(geometry.direction_error, difference - 4 * error - offsets / d);
            error += difference;
            edge.direction = *known;
        }
        geometry.note_rounding(to, edge.direction, error);
        if (i > 0) geometry.note_rounding(path.vertex(i).point, edge.direction, error);
        geometry.edges.push_back(edge);
    }
    return geometry;
}

std::optional<Scattering> PathOracle::scattering_at(const PathView& path, const Geometry& geometry,
                                                    int i) const {
    const PathVertex& vertex = path.vertex(i);
    const Vec3 to_camera = -geometry.edge(i - 1).direction;
    const Vec3 to_light = geometry.edge(i).direction;
    const bool is_delta = scatters_by_delta(path, i);
    const auto from_camera =
        way(scene_, vertex.point, is_delta, to_camera, to_light, Transport::Radiance);
    const auto from_light =
        way(scene_, vertex.point, is_delta, to_light, to_camera, Transport::Importance);
    if (!from_camera || !from_light) return std::nullopt;
    return Scattering{.pdf_to_light = from_camera->pdf,
                      .pdf_to_camera = from_light->pdf,
                      .f_cos_cos_from_camera = from_camera->f_cos_cos,
                      .f_cos_cos_from_light = from_light->f_cos_cos};
}

Rgb PathOracle::end_at_light(const PathView& path, const Geometry& geometry,
                             PathDensities& densities) const {
    const int n = path.n_edges();
    const auto last = static_cast<std::size_t>(n);
    const SurfacePoint& end = path.vertex(n).point;
    const Light& light = scene_.lights()[end.light];
    const Vec3 w = -geometry.edge(n - 1).direction;  // of emission
    const double chosen = emission_choice_.probability(end.light);
    const EmissionPdf emission = emission_pdf(scene_, end.light, end, w);

    densities.from_light[last] = chosen;
    if (light.is_surface()) densities.from_light[last] *= emission.position;
    if (geometry.is_infinite) densities.from_light[last] *= emission.direction;
    if (light.is_delta()) densities.from_camera[last] = 0;
    if (n > 1) {
        const SurfacePoint& before = path.vertex(n - 1).point;
        // A photon that is merged knows the light from its own place.
        const Vec3 from = path.light.size() > 1 ? path.light[1].point.position : before.position;
        densities.from_light[last - 1] = geometry.is_infinite
                                             ? emission.position * abs_cos(before.normal, w)
                                             : emission.direction * geometry.to_area(n - 1, before);
        densities.next_event = next_event_.probability(end.light, from);
        if (light.is_surface()) {
            densities.next_event *= light_pdf(scene_, from, end) * geometry.to_area(n - 1, end);
        } else if (light.shape == Light::Shape::Environment) {
            densities.next_event *= scene_.environment()->pdf(-w);
        }
        // What arrives of a point in space is asked where it arrives.
        if (light.is_delta()) {
            const auto met = sample_light(scene_, end.light, from, {});
            if (!met) return {};
            return static_cast<float>(geometry.edge(n - 1).length2) * met->radiance;
        }
    }
    if (geometry.is_infinite) return scene_.background(-w);
    return static_cast<float>(abs_cos(end.normal, w)) * scene_.emitted(end, w);
}

PathOracle::Answer PathOracle::ask(const PathView& path) const {
    const int n = path.n_edges();
    Answer answer;
    PathDensities& densities = answer.densities;
    densities.make_room(n);
    densities.n_edges = n;
    const Geometry geometry = geometry_of(path);
    answer.direction_error = geometry.direction_error;
    answer.rounding = geometry.rounding;
    const auto is_direction = [&](int i) { return geometry.is_infinite && i == n; };

    const double per_pixel = camera_.pdf_direction(geometry.edge(0).direction);
    densities.from_camera[1] =
        is_direction(1) ? per_pixel : per_pixel * geometry.to_area(0, path.vertex(1).point);
    answer.pixel_area = geometry.edge(0).length2 / per_pixel;
    double factor = is_direction(1) ? per_pixel : per_pixel / geometry.edge(0).length2;
    std::array<double, 3> product_from_camera{1, 1, 1};
    std::array<double, 3> product_from_light{1, 1, 1};
    for (int i = 1; i < n; ++i) {
        const auto at = static_cast<std::size_t>(i);
        densities.is_delta[at] = scatters_by_delta(path, i);
        const auto scattering = scattering_at(path, geometry, i);
        if (!scattering) {
            answer.misses_delta_lobe = true;
            return answer;
        }
        densities.from_camera[at + 1] = scattering->pdf_to_light;
        if (!is_direction(i + 1)) {
            densities.from_camera[at + 1] *= geometry.to_area(i, path.vertex(i + 1).point);
            factor /= geometry.edge(i).length2;
        }
        if (i > 1) {
            densities.from_light[at - 1] =
                scattering->pdf_to_camera * geometry.to_area(i - 1, path.vertex(i - 1).point);
        }
        for (std::size_t c = 0; c < 3; ++c) {
            product_from_camera[c] *= scattering->f_cos_cos_from_camera[c];
            product_from_light[c] *= scattering->f_cos_cos_from_light[c];
        }
    }
    const Rgb emitted = end_at_light(path, geometry, densities);
    const std::array emission = {double{emitted.r}, double{emitted.g}, double{emitted.b}};
    for (std::size_t c = 0; c < 3; ++c) {
        answer.from_camera[c] = factor * product_from_camera[c] * emission[c];
        answer.from_light[c] = factor * product_from_light[c] * emission[c];
    }
    return answer;
}

}  // namespace misbench::test
