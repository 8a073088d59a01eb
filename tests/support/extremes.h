// Extreme scenes rendered, and what they must look like.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/extremes/extreme_scenes.h"
#include "renderer/methods/render_loop.h"

namespace misbench::test {

inline SceneDescription extreme_scene(std::string_view name) {
    for (const extremes::ExtremeScene& row : extremes::extreme_scenes()) {
        if (row.name == name) return row.make();
    }
    ADD_FAILURE() << name;
    return {};
}

struct Frame2 {
    int width, height, samples;
};

// Valid means that no sample is infinite, NaN or negative.
inline Image image_by(const std::string& method, const Scene& scene, const ParameterMap& parameters,
                      Frame2 frame, std::int64_t seed = 1) {
    RenderResult result = render(scene, {.method = method,
                                         .parameters = parameters,
                                         .width = frame.width,
                                         .height = frame.height,
                                         .budget = SampleBudget{frame.samples},
                                         .seed = seed,
                                         .threads = 2});
    EXPECT_TRUE(result.valid) << method;
    return std::move(result.image);
}

inline double mean_of(const Image& image) {
    double sum = 0;
    for (const float value : image.rgb) sum += double{value};
    return sum / static_cast<double>(image.rgb.size());
}

inline std::vector<double> means_by(const std::string& method, const Scene& scene,
                                    const ParameterMap& parameters, Frame2 frame, int seeds) {
    std::vector<double> values;
    for (int seed = 0; seed < seeds; ++seed) {
        values.push_back(mean_of(image_by(method, scene, parameters, frame, 100 + seed)));
    }
    return values;
}

// The form factor of a w × d rectangle at height h from a parallel element below its centre, by
// integration of cos⁴θ / (π h²) over it.
inline double form_factor(double w, double d, double h) {
    const double a = w / (2 * h);
    const double b = d / (2 * h);
    const double ra = std::sqrt(1 + a * a);
    const double rb = std::sqrt(1 + b * b);
    return 2 / M_PI * (a / ra * std::atan(b / ra) + b / rb * std::atan(a / rb));
}

// What the floor below the lamp reflects.
inline double floor_radiance(const extremes::FloorAndLamp& layout) {
    return double{extremes::kFloorAlbedo} * double{layout.radiance.r} *
           form_factor(double{layout.lamp_width}, double{layout.lamp_depth},
                       double{layout.lamp_height});
}

// The area of the corners as they are: rounding them changes that of a tiny lamp.
inline double area_of(const Mesh& mesh) {
    double area = 0;
    for (const auto& [i, j, k] : mesh.triangles) {
        const auto edge = [&](std::uint32_t to) {
            const Vec3 a = mesh.positions[i];
            const Vec3 b = mesh.positions[to];
            return std::array{double{b.x} - double{a.x}, double{b.y} - double{a.y},
                              double{b.z} - double{a.z}};
        };
        const auto [ux, uy, uz] = edge(j);
        const auto [vx, vy, vz] = edge(k);
        area += std::hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx) / 2;
    }
    return area;
}

// What the floor below a tiny lamp reflects: L A cosθ cosθ' / d², both cosines 1.
inline double tiny_lamp_radiance(double radiance, double area, double height) {
    return double{extremes::kFloorAlbedo} / M_PI * radiance * area / (height * height);
}

// Radiance is Σ ρ^k over the first n edges along every path of the white box.
inline double white_box_radiance(double albedo, double n_edges) {
    return (1 - std::pow(albedo, n_edges)) / (1 - albedo);
}

// The part of values that differ by more than a thousandth of the mean: paths that rounding sends
// another way.
inline double part_that_differs(const Image& a, const Image& b) {
    const double tolerance = 1e-3 * mean_of(a);
    int n = 0;
    for (std::size_t i = 0; i < a.rgb.size(); ++i) {
        n += std::abs(double{a.rgb[i]} - double{b.rgb[i]}) > tolerance ? 1 : 0;
    }
    return n / static_cast<double>(a.rgb.size());
}

// By how much, relatively, the means over blocks of 16² pixels differ at the most.
inline double worst_block(const Image& a, const Image& b) {
    constexpr std::size_t kBlock = 16;
    const auto block_means = [](const Image& image) {
        const auto width = static_cast<std::size_t>(image.width);
        const std::size_t blocks = width / kBlock;
        std::vector<double> values(blocks * static_cast<std::size_t>(image.height) / kBlock);
        for (std::size_t i = 0; i < image.rgb.size(); ++i) {
            const std::size_t pixel = i / 3;
            values[pixel / width / kBlock * blocks + pixel % width / kBlock] +=
                double{image.rgb[i]} / (3 * kBlock * kBlock);
        }
        return values;
    };
    const std::vector<double> of_a = block_means(a);
    const std::vector<double> of_b = block_means(b);
    double worst = 0;
    for (std::size_t i = 0; i < of_a.size(); ++i) {
        worst = std::max(worst, std::abs(of_a[i] / of_b[i] - 1));
    }
    return worst;
}

}  // namespace misbench::test
