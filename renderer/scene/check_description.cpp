// The checks of inspect.h that read a description: edges, copies, normals, degenerate triangles.
#include <algorithm>
#include <bit>
#include <map>
#include <numeric>
#include <tuple>

#include "renderer/scene/inspect.h"

namespace misbench {
namespace {

using Kind = SceneWarning::Kind;

// Corner normals may lean over their face by this much, which is the rounding of a file's digits.
constexpr float kOpposed = -1e-3F;

bool emits(const Mesh& mesh) { return !(mesh.emission == Rgb{}); }

std::string quoted(const std::string& name) { return name.empty() ? "" : " '" + name + "'"; }

std::string label(const std::string& what, std::size_t index, const std::string& name,
                  const SurfaceMaterial& material) {
    return what + " " + std::to_string(index) + quoted(name) +
           (material.name.empty() ? "" : " (material" + quoted(material.name) + ")");
}

// "1 triangle has", "3 triangles have".
std::string triangles_have(std::size_t n) {
    return std::to_string(n) + (n == 1 ? " triangle has" : " triangles have");
}

auto order(Vec3 p) { return std::tuple(p.x, p.y, p.z); }
bool is_before(Vec3 a, Vec3 b) { return order(a) < order(b); }

// For every vertex the first one, by any order, at its exact position.
std::vector<std::uint32_t> weld(const std::vector<Vec3>& positions) {
    std::vector<std::uint32_t> by_position(positions.size());
    std::iota(by_position.begin(), by_position.end(), 0U);
    std::sort(by_position.begin(), by_position.end(), [&](std::uint32_t a, std::uint32_t b) {
        return is_before(positions[a], positions[b]);
    });
    std::vector<std::uint32_t> welded(positions.size());
    std::uint32_t first = 0;
    for (const std::uint32_t vertex : by_position) {
        if (vertex == by_position.front() || !(positions[vertex] == positions[first])) {
            first = vertex;
        }
        welded[vertex] = first;
    }
    return welded;
}

// The triangles that have an area, over welded vertices, copies left out.
std::vector<TriangleIndices> proper_triangles(const Mesh& mesh) {
    const std::vector<std::uint32_t> welded = weld(mesh.positions);
    std::vector<std::pair<TriangleIndices, TriangleIndices>> sorted;  // by corners in any order
    for (const TriangleIndices& corners : mesh.triangles) {
        if (!(facet(mesh, corners).area > 0)) continue;
        const TriangleIndices triangle = {welded[corners[0]], welded[corners[1]],
                                          welded[corners[2]]};
        sorted.push_back({triangle, triangle});
        std::sort(sorted.back().first.begin(), sorted.back().first.end());
    }
    std::sort(sorted.begin(), sorted.end());
    std::vector<TriangleIndices> triangles;
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        if (i > 0 && sorted[i].first == sorted[i - 1].first) continue;
        triangles.push_back(sorted[i].second);
    }
    return triangles;
}

struct EdgeCounts {
    std::size_t n_open = 0;         // of one triangle
    std::size_t n_conflicting = 0;  // of two triangles that run along it in the same direction
    std::size_t n_crowded = 0;      // of more than two
};

EdgeCounts count_edges(const Mesh& mesh) {
    struct Edge {
        std::uint32_t low, high;
        bool upwards;
    };
    std::vector<Edge> edges;
    for (const auto& [a, b, c] : proper_triangles(mesh)) {
        for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) {
            edges.push_back({std::min(from, to), std::max(from, to), from < to});
        }
    }
    const auto ends = [](const Edge& e) { return std::pair{e.low, e.high}; };
    std::sort(edges.begin(), edges.end(),
              [&](const Edge& a, const Edge& b) { return ends(a) < ends(b); });
    EdgeCounts counts;
    for (std::size_t i = 0, next = 0; i < edges.size(); i = next) {
        next = i + 1;
        while (next < edges.size() && ends(edges[next]) == ends(edges[i])) ++next;
        if (next - i == 1) ++counts.n_open;
        if (next - i == 2 && edges[i].upwards == edges[i + 1].upwards) ++counts.n_conflicting;
        if (next - i > 2) ++counts.n_crowded;
    }
    return counts;
}

class DescriptionCheck {
 public:
    explicit DescriptionCheck(const SceneDescription& scene) : scene_(scene) {}

    std::vector<SceneWarning> run() {
        for (std::size_t i = 0; i < scene_.meshes.size(); ++i) {
            check_areas(i);
            check_edges(i);
            check_normals(i);
            check_uv(i);
        }
        check_copies();
        return std::move(warnings_);
    }

 private:
    void warn(Kind kind, std::size_t mesh, const std::string& message) {
        warnings_.push_back({kind, label_of(mesh), message});
    }
    std::string label_of(std::size_t mesh) const {
        const Mesh& m = scene_.meshes[mesh];
        return label("mesh", mesh, m.name, scene_.materials[m.material]);
    }

    void check_areas(std::size_t index) {
        const Mesh& mesh = scene_.meshes[index];
        const auto n = static_cast<std::size_t>(
            std::count_if(mesh.triangles.begin(), mesh.triangles.end(),
                          [&](const TriangleIndices& t) { return !(facet(mesh, t).area > 0); }));
        if (emits(mesh) && n == mesh.triangles.size()) {
            warn(Kind::EmitterWithoutArea, index, "it emits, but has no area");
        } else if (n > 0) {
            warn(emits(mesh) ? Kind::EmitterWithoutArea : Kind::DegenerateTriangles, index,
                 triangles_have(n) + " no area" + (emits(mesh) ? " and cannot emit" : ""));
        }
    }

    void check_edges(std::size_t index) {
        const EdgeCounts edges = count_edges(scene_.meshes[index]);
        if (edges.n_conflicting > 0) {
            warn(Kind::WindingConflict, index,
                 std::to_string(edges.n_conflicting) +
                     (edges.n_conflicting == 1 ? " edge lies" : " edges lie") +
                     " between two triangles that wind against each other");
        }
        if (edges.n_crowded > 0) {
            warn(Kind::SharedEdges, index,
                 std::to_string(edges.n_crowded) +
                     (edges.n_crowded == 1 ? " edge belongs" : " edges belong") +
                     " to more than two triangles");
        }
    }

    void check_normals(std::size_t index) {
        const Mesh& mesh = scene_.meshes[index];
        if (mesh.normals.empty()) return;
        std::size_t n_any = 0;
        std::size_t n_all = 0;
        for (const TriangleIndices& corners : mesh.triangles) {
            const Facet face = facet(mesh, corners);
            if (!(face.area > 0)) continue;
            const auto n = std::count_if(corners.begin(), corners.end(), [&](std::uint32_t c) {
                return dot(mesh.normals[c], face.normal) < kOpposed;
            });
            if (n > 0) ++n_any;
            if (n == 3) ++n_all;
        }
        if (n_any == 0) return;
        const std::string text = triangles_have(n_any) +
                                 " corner normals that oppose their winding, " +
                                 std::to_string(n_all) + " of them at all three corners";
        if (emits(mesh)) {
            warn(Kind::OpposedEmitterNormals, index, text + "; light leaves by the normals");
        } else {
            warn(Kind::OpposedNormals, index, text);
        }
    }

    void check_uv(std::size_t index) {
        const Mesh& mesh = scene_.meshes[index];
        if (mesh.uvs.empty() && has_texture(scene_.materials[mesh.material])) {
            warn(Kind::MissingUv, index, "its material has textures, but the mesh has no uv");
        }
    }

    void check_copies();

    const SceneDescription& scene_;
    std::vector<SceneWarning> warnings_;
};

// A triangle of a mesh, found again by a hash of its corners' positions in any order.
struct HashedTriangle {
    std::uint64_t hash;
    std::uint32_t mesh;
    std::uint32_t triangle;
    auto operator<=>(const HashedTriangle&) const = default;
};

using Corners = std::array<Vec3, 3>;

Corners sorted_corners(const Mesh& mesh, const TriangleIndices& triangle) {
    Corners corners = {mesh.positions[triangle[0]], mesh.positions[triangle[1]],
                       mesh.positions[triangle[2]]};
    std::sort(corners.begin(), corners.end(), is_before);
    return corners;
}

std::uint64_t hash_of(const Corners& corners) {
    std::uint64_t hash = 0xcbf29ce484222325;  // FNV-1a over words, then mixed
    for (const Vec3 p : corners) {
        for (const float x : {p.x, p.y, p.z}) {
            const float unsigned_zero = x + 0.0F;
            hash = (hash ^ std::bit_cast<std::uint32_t>(unsigned_zero)) * 0x100000001b3;
            hash ^= hash >> 29;
        }
    }
    return hash;
}

void DescriptionCheck::check_copies() {
    std::vector<HashedTriangle> triangles;
    for (std::uint32_t m = 0; m < scene_.meshes.size(); ++m) {
        const Mesh& mesh = scene_.meshes[m];
        for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
            if (!(facet(mesh, mesh.triangles[t]).area > 0)) continue;
            triangles.push_back({hash_of(sorted_corners(mesh, mesh.triangles[t])), m, t});
        }
    }
    std::sort(triangles.begin(), triangles.end());
    const auto corners_of = [&](const HashedTriangle& t) {
        const Mesh& mesh = scene_.meshes[t.mesh];
        return sorted_corners(mesh, mesh.triangles[t.triangle]);
    };
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> n_copies;  // by mesh and first
    for (std::size_t i = 1, first = 0; i < triangles.size(); ++i) {
        if (triangles[i].hash != triangles[first].hash ||
            corners_of(triangles[i]) != corners_of(triangles[first])) {
            first = i;
        } else {
            ++n_copies[{triangles[i].mesh, triangles[first].mesh}];
        }
    }
    for (const auto& [meshes, n] : n_copies) {
        const auto [mesh, first] = meshes;
        warn(Kind::DuplicateTriangles, mesh,
             triangles_have(n) + " the same corners as others of " +
                 (mesh == first ? "this mesh" : label_of(first)));
    }
}

}  // namespace

std::vector<SceneWarning> check_description(const SceneDescription& description) {
    return DescriptionCheck(description).run();
}

std::vector<SceneObject> scene_objects(const SceneDescription& description) {
    std::vector<SceneObject> objects;
    std::size_t end = 0;
    for (std::size_t i = 0; i < description.meshes.size(); ++i) {
        const Mesh& mesh = description.meshes[i];
        for (const TriangleIndices& corners : mesh.triangles) {
            if (facet(mesh, corners).area > 0) ++end;
        }
        const EdgeCounts edges = count_edges(mesh);
        objects.push_back(
            {.label = label("mesh", i, mesh.name, description.materials[mesh.material]),
             .is_quadric = false,
             .end = end,
             .is_closed = edges.n_open + edges.n_conflicting + edges.n_crowded == 0});
    }
    for (std::size_t i = 0; i < description.quadrics.size(); ++i) {
        const Quadric& quadric = description.quadrics[i];
        objects.push_back({.label = label(std::string(name(quadric.shape)), i, quadric.name,
                                          description.materials[quadric.material]),
                           .is_quadric = true,
                           .end = i + 1,
                           .is_closed = quadric.shape == Quadric::Shape::Sphere});
    }
    return objects;
}

}  // namespace misbench
