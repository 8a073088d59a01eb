// All densities of a full path, and what it contributes, from its vertices alone: positions,
// normals, materials, which of them scatter by a delta lobe. For tests of methods that collect the
// same numbers on the way.
//
// Conventions are those of path_densities.h. A delta lobe has two densities for one scattering,
// whose ratio follows from η_i² cosθ_i dω_i = η_o² cosθ_o dω_o; its probability P is multiplied by
// the root of that ratio in the one direction and divided in the other:
//     p(wi | wo) = P η √(cosθ_i / cosθ_o),   p(wo | wi) = P / η √(cosθ_o / cosθ_i),
// η of wi's side over wo's, cosines with the shading normal. Mirrors and what goes straight on have
// a factor of 1.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "renderer/math/discrete_distribution.h"
#include "renderer/paths/sample.h"
#include "renderer/scene/camera.h"
#include "renderer/scene/light_sampler.h"

namespace misbench::test {

// What one vertex does with light that comes from x_{i+1} and goes on to x_{i-1}.
struct Scattering {
    double pdf_to_light = 0;   // of going on to x_{i+1} from x_{i-1}; solid angle measure
    double pdf_to_camera = 0;  // of going on to x_{i-1} from x_{i+1}
    // f times the cosines to both sides, asked of the BSDF of a path from the camera, and of one
    // from the light: the same number.
    std::array<double, 3> f_cos_cos_from_camera{};
    std::array<double, 3> f_cos_cos_from_light{};
};

class PathOracle {
 public:
    // The light of a path's start is chosen by power, or alike for all where `light_selection` is
    // "uniform".
    PathOracle(const Scene& scene, int width, int height, const std::string& light_selection);

    struct Answer {
        PathDensities densities;  // without merge_area
        double pixel_area = 0;    // of the pixel seen at x_1, across the camera ray
        // The measurement contribution f: value = f / q_t for the technique that made the path.
        // By the BSDFs of a path from the camera and of one from the light.
        std::array<double, 3> from_camera{};
        std::array<double, 3> from_light{};
        // The largest angle between a direction that a vertex remembers and the one between the
        // positions, beyond what the starts of rays account for.
        double direction_error = 0;
        // By how much the cosines at both ends of an edge may be wrong, relative, at worst:
        // positions are float and rays start off surfaces, which matters where an edge is short or
        // runs along a surface.
        double rounding = 0;
        // A delta vertex has no delta lobe in the path's direction.
        bool misses_delta_lobe = false;
    };
    // REQUIRES: the camera is a pinhole, or x_1 is a vertex of the camera's subpath.
    Answer ask(const PathView& path) const;

 private:
    struct Geometry;

    Geometry geometry_of(const PathView& path) const;
    std::optional<Scattering> scattering_at(const PathView& path, const Geometry& geometry,
                                            int i) const;
    // What depends on the kind of light: C_n, L_n, L_{n-1}, p_nee. Returns the emission's part in
    // f.
    Rgb end_at_light(const PathView& path, const Geometry& geometry,
                     PathDensities& densities) const;

    const Scene& scene_;
    Camera camera_;
    LightSampler next_event_;
    DiscreteDistribution emission_choice_;
};

}  // namespace misbench::test
