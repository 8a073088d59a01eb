// Samples of paths that nobody traced, for tests of what watches samples.
#pragma once

#include <utility>
#include <vector>

#include "renderer/paths/sample.h"

namespace misbench::test {

// A sample with its path. Camera vertices lie at (i, 0, 0), those of the light's subpath too, by
// their place in the path; C_i is 10 i, L_i is 20 i.
struct MadeUpSample {
    MadeUpSample(Pixel pixel, int n_edges, Technique technique, Rgb value, double weight)
        : q(static_cast<std::size_t>(n_techniques(n_edges)), 0.25) {
        const int n_camera = technique.kind == TechniqueKind::Hit         ? n_edges
                             : technique.kind == TechniqueKind::NextEvent ? n_edges - 1
                                                                          : technique.k;
        const bool merges = technique.kind == TechniqueKind::Merge;
        densities.make_room(n_edges);
        densities.n_edges = n_edges;
        for (int i = 1; i <= n_edges; ++i) {
            densities.from_camera[static_cast<std::size_t>(i)] = 10 * i;
            densities.from_light[static_cast<std::size_t>(i)] = 20 * i;
        }
        for (int i = 1; i <= n_camera; ++i) camera.push_back(vertex<PathVertex>(i));
        for (int i = n_edges; i > n_camera - (merges ? 1 : 0); --i) {
            light.push_back(vertex<LightVertex>(i));
        }
        q[static_cast<std::size_t>(technique.index(n_edges))] = 1;
        path = {.densities = &densities, .pixel = pixel, .camera = camera, .light = light};
        sample.technique = technique;
        sample.value = value;
        sample.weight = weight;
        sample.q = q;
    }
    MadeUpSample(const MadeUpSample&) = delete;
    MadeUpSample& operator=(const MadeUpSample&) = delete;

    PathDensities densities;
    std::vector<PathVertex> camera;
    std::vector<LightVertex> light;
    std::vector<double> q;
    PathView path;
    Sample sample{.path = path};

 private:
    template <class Vertex>
    static Vertex vertex(int i) {
        Vertex vertex;
        vertex.point.position = {static_cast<float>(i), 0, 0};
        return vertex;
    }
};

}  // namespace misbench::test
