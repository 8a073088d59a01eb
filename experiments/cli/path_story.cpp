#include "experiments/cli/path_story.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "experiments/cli/output.h"
#include "renderer/paths/technique_images.h"

namespace misbench {
namespace {

using Json = nlohmann::ordered_json;
using Rows = std::vector<std::vector<std::string>>;

enum class VertexKind { Surface, Delta, Light, Infinite };

std::string_view name(VertexKind kind) {
    switch (kind) {
        case VertexKind::Surface:
            return "surface";
        case VertexKind::Delta:
            return "delta";
        case VertexKind::Light:
            return "light";
        case VertexKind::Infinite:
            return "infinite";
    }
    return "";
}

// What is known of x_i, 1 <= i <= n.
struct VertexFacts {
    VertexKind kind = VertexKind::Surface;
    const PathVertex* vertex = nullptr;
    bool has_surface = true;
    std::string_view material{};
    double from_camera = 0;
    double from_light = 0;
};

VertexFacts facts(const KeptSample& sample, std::size_t i, const Scene& scene) {
    const PathVertex& vertex = sample.vertices[i - 1];
    VertexFacts facts{.vertex = &vertex,
                      .from_camera = sample.densities.from_camera[i],
                      .from_light = sample.densities.from_light[i]};
    if (i == sample.vertices.size()) {
        const Light& light = scene.lights()[vertex.point.light];
        facts.kind = light.is_infinite() ? VertexKind::Infinite : VertexKind::Light;
        facts.has_surface = light.is_surface();
    } else if (sample.densities.is_delta[i] != 0) {
        facts.kind = VertexKind::Delta;
    }
    if (vertex.point.material != nullptr) facts.material = vertex.point.material->name;
    return facts;
}

// Nothing is weighed where only one technique can have made the path.
bool has_densities(const KeptSample& sample) { return sample.densities.n_edges > 1; }

RgbSum in_double(Rgb v) { return {double{v.r}, double{v.g}, double{v.b}}; }

RgbSum weighted(const KeptSample& sample) {
    const auto [r, g, b] = in_double(sample.value);
    return {sample.weight * r, sample.weight * g, sample.weight * b};
}

// --- text ----------------------------------------------------------------------------------------

std::string to_text(Vec3 v) { return fmt::format("{:.6g} {:.6g} {:.6g}", v.x, v.y, v.z); }

std::string vertices_to_text(const KeptSample& sample, const Scene& scene) {
    Rows rows{{"  vertex", "kind", "material", "position", "normal", "C", "L"}, {"  x0", "camera"}};
    for (std::size_t i = 1; i <= sample.vertices.size(); ++i) {
        const VertexFacts f = facts(sample, i, scene);
        const SurfacePoint& point = f.vertex->point;
        rows.push_back({fmt::format("  x{}", i), std::string(name(f.kind)), std::string(f.material),
                        f.kind == VertexKind::Infinite ? "towards " + to_text(-f.vertex->wo)
                                                       : to_text(point.position),
                        f.has_surface ? to_text(point.normal) : ""});
        if (!has_densities(sample)) continue;
        rows.back().push_back(fmt::format("{:.6g}", f.from_camera));
        rows.back().push_back(fmt::format("{:.6g}", f.from_light));
    }
    if (sample.photon) {
        const SurfacePoint& point = sample.photon->point;
        rows.push_back({"  photon", "", "", to_text(point.position), to_text(point.normal)});
    }
    return align(rows);
}

std::string techniques_to_text(const KeptSample& sample) {
    const int n_edges = sample.densities.n_edges;
    Rows rows{{"  technique"}, {"  q"}};
    if (!sample.factors.empty()) rows.push_back({"  factor"});
    for (std::size_t t = 0; t < sample.q.size(); ++t) {
        const Technique technique = technique_at(static_cast<int>(t), n_edges);
        rows[0].push_back(technique_name(technique) + (technique == sample.technique ? "*" : ""));
        rows[1].push_back(fmt::format("{:.6g}", sample.q[t]));
        if (rows.size() == 3) rows[2].push_back(fmt::format("{:.6g}", sample.factors[t]));
    }
    return align(rows);
}

// --- JSON ----------------------------------------------------------------------------------------

Json to_json(double value) {
    if (std::isfinite(value)) return value;
    return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
}
Json to_json(Vec3 v) {
    return Json::array({to_json(double{v.x}), to_json(double{v.y}), to_json(double{v.z})});
}

Json vertices_to_json(const KeptSample& sample, const Scene& scene) {
    Json vertices = Json::array({{{"kind", "camera"}}});
    for (std::size_t i = 1; i <= sample.vertices.size(); ++i) {
        const VertexFacts f = facts(sample, i, scene);
        const SurfacePoint& point = f.vertex->point;
        Json vertex{{"kind", name(f.kind)}};
        if (f.kind == VertexKind::Infinite) {
            vertex["direction"] = to_json(-f.vertex->wo);
        } else {
            vertex["position"] = to_json(point.position);
        }
        if (f.has_surface) {
            vertex["normal"] = to_json(point.normal);
            vertex["shading_normal"] = to_json(point.shading_normal);
            vertex["material"] = f.material;
        }
        if (has_densities(sample)) {
            vertex["C"] = to_json(f.from_camera);
            vertex["L"] = to_json(f.from_light);
        }
        vertices.push_back(std::move(vertex));
    }
    return vertices;
}

// By the names of the techniques.
Json by_technique(std::span<const double> values, int n_edges) {
    Json json = Json::object();
    for (std::size_t t = 0; t < values.size(); ++t) {
        json[technique_name(technique_at(static_cast<int>(t), n_edges))] = to_json(values[t]);
    }
    return json;
}

Json sample_to_json(const KeptSample& sample, const Scene& scene) {
    const int n_edges = sample.densities.n_edges;
    Json json{{"technique", technique_name(sample.technique)},
              {"n_edges", n_edges},
              {"vertices", vertices_to_json(sample, scene)}};
    if (sample.photon) {
        json["photon"] = {{"position", to_json(sample.photon->point.position)},
                          {"normal", to_json(sample.photon->point.normal)}};
    }
    if (has_densities(sample)) {
        json["p_nee"] = to_json(sample.densities.next_event);
        json["merge_area"] = to_json(sample.densities.merge_area);
    }
    json["q"] = by_technique(sample.q, n_edges);
    if (!sample.factors.empty()) json["factors"] = by_technique(sample.factors, n_edges);
    json["weight"] = to_json(sample.weight);
    json["value"] = rgb_to_json(in_double(sample.value));
    json["weighted_value"] = rgb_to_json(weighted(sample));
    return json;
}

}  // namespace

std::vector<KeptSample> by_weighted_value(std::vector<KeptSample> samples) {
    const auto size = [](const KeptSample& sample) {
        double largest = 0;
        for (const double channel : weighted(sample)) {
            if (!std::isfinite(channel)) return std::numeric_limits<double>::infinity();
            largest = std::max(largest, std::abs(channel));
        }
        return largest;
    };
    std::ranges::stable_sort(samples, std::ranges::greater(), size);
    return samples;
}

RgbSum weighted_sum(std::span<const KeptSample> samples) {
    RgbSum sum{};
    for (const KeptSample& sample : samples) {
        const RgbSum value = weighted(sample);
        for (std::size_t c = 0; c < 3; ++c) sum[c] += value[c];
    }
    return sum;
}

std::string story_to_text(std::span<const KeptSample> samples, const Scene& scene) {
    std::string text;
    for (const KeptSample& sample : samples) {
        const PathDensities& densities = sample.densities;
        text += fmt::format("\n{}, path of {} edge{}: weight {:.9g} · value {} = {}\n",
                            technique_name(sample.technique), densities.n_edges,
                            densities.n_edges == 1 ? "" : "s", sample.weight,
                            rgb_to_text(in_double(sample.value)), rgb_to_text(weighted(sample)));
        text += vertices_to_text(sample, scene) + techniques_to_text(sample);
        if (has_densities(sample)) {
            text += fmt::format("  p_nee {:.6g}, πr² {:.6g}\n", densities.next_event,
                                densities.merge_area);
        }
    }
    return text;
}

std::string rgb_to_text(const RgbSum& rgb) {
    return fmt::format("{:.9g} {:.9g} {:.9g}", rgb[0], rgb[1], rgb[2]);
}

nlohmann::ordered_json story_to_json(std::span<const KeptSample> samples, const Scene& scene) {
    Json json = Json::array();
    for (const KeptSample& sample : samples) json.push_back(sample_to_json(sample, scene));
    return json;
}

nlohmann::ordered_json rgb_to_json(const RgbSum& rgb) {
    return Json::array({to_json(rgb[0]), to_json(rgb[1]), to_json(rgb[2])});
}

}  // namespace misbench
