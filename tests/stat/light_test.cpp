// Every light: its next event samples, the emission of its paths and its power against each other
// and against what rays find. A new light is a row of rows().
#include <gtest/gtest.h>

#include <random>

#include "renderer/base/rng.h"
#include "renderer/math/warp.h"
#include "renderer/scene/light_transport.h"
#include "tests/support/scenes.h"
#include "tests/support/statistics.h"

namespace misbench {
namespace {

// One false alarm among all comparisons of this binary with this probability.
constexpr double kAlpha = 0.01;

struct Row {
    std::string name;
    SceneDescription scene;  // one light over a receiver
    double power;            // W, luminance
};

constexpr float kReceiver = 0.5F;  // half its side

// A black square at the origin that looks up; lights shine on it from above.
SceneDescription receiver() {
    SceneDescription scene;
    scene.materials = {test::surface(DiffuseMaterial{})};
    const float r = kReceiver;
    scene.meshes.push_back(test::quad({-r, 0, r}, {r, 0, r}, {r, 0, -r}, {-r, 0, -r}, 0));
    return scene;
}

Quadric quadric(Quadric::Shape shape, const Transform& to_world, bool flipped = false) {
    return {.shape = shape,
            .to_world = to_world,
            .flipped = flipped,
            .name = "q",
            .material = 0,
            .emission = {3, 3, 3}};
}

SceneDescription with(const Quadric& light) {
    SceneDescription scene = receiver();
    scene.quadrics.push_back(light);
    return scene;
}

// A map of 8 × 4 pixels with a bright and a dim one in its upper half.
std::shared_ptr<const Image> sky() {
    Image image(8, 4);
    const auto set = [&image](std::size_t x, std::size_t y, float value) {
        for (std::size_t c = 0; c < 3; ++c) image.rgb[3 * (8 * y + x) + c] = value;
    };
    set(2, 1, 40);
    set(6, 0, 4);
    return std::make_shared<const Image>(std::move(image));
}

const std::vector<Row>& rows() {
    static const std::vector<Row> kRows = [] {
        std::vector<Row> all;
        {
            SceneDescription scene = receiver();
            Mesh triangle;
            triangle.positions = {{-0.5F, 1, -0.2F}, {0.7F, 1.2F, -0.4F}, {0.1F, 1.1F, 0.6F}};
            triangle.triangles = {{0, 1, 2}};
            triangle.emission = {3, 3, 3};
            scene.meshes.push_back(triangle);
            // Half of |(1.2, 0.2, -0.2) × (0.6, 0.1, 0.8)| = |(0.18, -1.08, 0)| / 2.
            all.push_back({"triangle", scene, M_PI * 3 * 0.5 * std::hypot(0.18, 1.08)});
        }
        const auto at = [](Vec3 x, Vec3 y, Vec3 z, Vec3 p) {
            Transform t;
            t.rows = {{{x.x, y.x, z.x, p.x}, {x.y, y.y, z.y, p.y}, {x.z, y.z, z.z, p.z}}};
            return t;
        };
        const auto scaled = [&at](float s, Vec3 p) {
            return at({s, 0, 0}, {0, s, 0}, {0, 0, s}, p);
        };
        all.push_back({"sphere", with(quadric(Quadric::Shape::Sphere, scaled(0.3F, {0.2F, 1, 0}))),
                       M_PI * 3 * 4 * M_PI * 0.09});
        all.push_back({"sphere_from_inside",
                       with(quadric(Quadric::Shape::Sphere, scaled(2, {0, 0.5F, 0}), true)),
                       M_PI * 3 * 4 * M_PI * 4});
        // z of the disk looks down.
        all.push_back({"disk",
                       with(quadric(Quadric::Shape::Disk,
                                    at({0.5F, 0, 0}, {0, 0, 0.3F}, {0, -1, 0}, {0.1F, 0.8F, 0}))),
                       M_PI * 3 * M_PI * 0.5 * 0.3});
        all.push_back({"cylinder",
                       with(quadric(Quadric::Shape::Cylinder,
                                    at({0, 0.2F, 0}, {0, 0, 0.2F}, {1.2F, 0, 0}, {-0.6F, 1, 0}))),
                       M_PI * 3 * 2 * M_PI * 0.2 * 1.2});
        SceneDescription scene = receiver();
        scene.point_lights = {{.position = {0.3F, 0.9F, 0}, .intensity = {2, 2, 2}}};
        all.push_back({"point", scene, 4 * M_PI * 2});
        scene = receiver();
        scene.spot_lights = {{.position = {0.3F, 1, 0.1F},
                              .direction = normalized({-0.3F, -1, 0}),
                              .intensity = {2, 2, 2},
                              .cutoff_angle = 0.5F,
                              .beam_width = 0.2F}};
        all.push_back({"spot", scene, 2 * 2 * M_PI * (1 - (std::sin(0.5) - std::sin(0.2)) / 0.3)});
        scene = receiver();
        scene.directional_lights = {
            {.direction = normalized({0.5F, -1, 0.2F}), .irradiance = {2, 2, 2}}};
        // The bounding sphere of the receiver has radius 0.5 √2.
        all.push_back({"directional", scene, 2 * M_PI * 0.5});
        scene = receiver();
        scene.environment = EnvironmentDescription{.radiance = sky()};
        // Row 1 covers cos θ from cos 45° to 0, row 0 from 1 to cos 45°.
        const double c = std::sqrt(0.5);
        all.push_back({"environment", scene, M_PI * 0.5 * (M_PI / 4) * (40 * c + 4 * (1 - c))});
        return all;
    }();
    return kRows;
}

class EveryLight : public testing::TestWithParam<std::size_t> {
 protected:
    const Row& row_ = rows()[GetParam()];
    const Scene scene_{row_.scene, 1};
    const std::uint32_t light_ = 0;
    // Four tests of each row have one comparison, one has eight.
    static double level() { return test::sidak(kAlpha, static_cast<int>(12 * rows().size())); }

    Vec2 uniforms(Rng& rng) const {
        const float u = rng.uniform();
        return {u, rng.uniform()};
    }
    LightRandom light_random(Rng& rng) const {
        const Vec2 u = uniforms(rng);
        return {u, uniforms(rng)};
    }
    SurfacePoint receiver_point(Rng& rng) const {
        return scene_.point_on(rng.uniform() < 0.5F ? 0 : 1, warp_triangle(uniforms(rng)));
    }
    // Radiance times cos θ of one next event sample, over its density.
    double irradiance_by_next_event(const SurfacePoint& from, Rng& rng) const {
        const auto end = sample_light(scene_, light_, from.position, light_random(rng));
        if (!end) return 0;
        const float cosine = dot(from.normal, end->wi);
        if (cosine <= 0) return 0;
        return visible(scene_, from, *end)
                   ? double{cosine} * double{luminance(end->radiance)} / end->pdf
                   : 0;
    }
};

TEST_P(EveryLight, IsOne) { EXPECT_EQ(scene_.lights().size(), 1U); }

TEST_P(EveryLight, EmitsItsPower) {
    EXPECT_NEAR(double{luminance(light_power(scene_, light_))}, row_.power, 1e-4 * row_.power);
    EXPECT_NEAR(light_bounds(scene_)[0].power, row_.power / M_PI, 1e-4 * row_.power);
    std::vector<double> fluxes;
    for (std::uint32_t i = 0; i < 100'000; ++i) {
        Rng rng(31, i, 0);
        const Vec2 position = uniforms(rng);
        const auto start = sample_emission(scene_, light_, position, light_random(rng));
        fluxes.push_back(!start ? 0
                                : double{luminance(start->emission)} *
                                      std::abs(double{dot(start->point.normal, start->w)}) /
                                      (start->pdf_position * start->pdf_direction));
    }
    EXPECT_GT(test::p_value_of_mean(fluxes, row_.power), level()) << row_.name;
}

TEST_P(EveryLight, KnowsTheDensitiesOfItsEmission) {
    for (std::uint32_t i = 0; i < 1000; ++i) {
        Rng rng(32, i, 0);
        const Vec2 position = uniforms(rng);
        const auto start = sample_emission(scene_, light_, position, light_random(rng));
        if (!start) continue;
        const EmissionPdf pdf = emission_pdf(scene_, light_, start->point, start->w);
        EXPECT_EQ(pdf.position, start->pdf_position);
        EXPECT_EQ(pdf.direction, start->pdf_direction);
    }
}

// What paths from the light carry to the receiver is what its points see of the light.
TEST_P(EveryLight, LightsTheReceiverAlikeFromBothSides) {
    std::vector<double> differences;
    const double area = 4 * double{kReceiver} * double{kReceiver};
    for (std::uint32_t i = 0; i < 400'000; ++i) {
        Rng rng(33, i, 0);
        const Vec2 position = uniforms(rng);
        const auto start = sample_emission(scene_, light_, position, light_random(rng));
        double from_light = 0;
        if (start) {
            const auto hit = scene_.closest({start->point.leave(start->w), start->w});
            if (hit && hit->light == kNoLight && dot(hit->normal, start->w) < 0) {
                from_light = double{luminance(start->emission)} *
                             std::abs(double{dot(start->point.normal, start->w)}) /
                             (start->pdf_position * start->pdf_direction * area);
            }
        }
        Rng other(34, i, 0);
        const SurfacePoint from = receiver_point(other);
        differences.push_back(1 + from_light - irradiance_by_next_event(from, other));
    }
    EXPECT_GT(test::p_value_of_mean(differences, 1), level()) << row_.name;
}

// Next event samples fall into the octants of directions, and into rings, as their density says;
// rays in uniform directions find what the density is there.
TEST_P(EveryLight, IsSampledWithItsDensity) {
    if (scene_.lights()[light_].is_delta()) return;
    SceneDescription description = row_.scene;
    description.meshes.erase(description.meshes.begin());  // the receiver is in the way
    const Scene scene(description, 1);
    const Vec3 from{0.1F, 0.05F, -0.1F};
    constexpr std::size_t kBins = 64;
    constexpr int kN = 400'000;
    const auto bin_of = [](Vec3 w) {
        const double turn = (std::atan2(double{w.z}, double{w.x}) / (2 * M_PI)) + 0.5;
        const auto a = std::min<std::size_t>(7, static_cast<std::size_t>(8 * turn));
        const auto b = static_cast<std::size_t>(std::min(7.0, 4 * (1 + double{w.y})));
        return 8 * a + b;
    };
    std::vector<double> observed(kBins, 0);
    double n_absent = 0;
    for (std::uint32_t i = 0; i < kN; ++i) {
        Rng rng(35, i, 0);
        const auto end = sample_light(scene, light_, from, light_random(rng));
        if (end) {
            observed[bin_of(end->wi)] += 1;
        } else {
            n_absent += 1;
        }
    }
    std::vector<double> expected(kBins, 0);
    std::vector<double> variance(kBins, 0);
    for (std::uint32_t i = 0; i < kN; ++i) {
        Rng rng(36, i, 0);
        const Vec3 w = warp_sphere(uniforms(rng));
        const auto hit = scene.closest({from, w});
        double pdf = 0;
        if (!hit && scene.environment() != nullptr) pdf = scene.environment()->pdf(w);
        if (hit && !(scene.emitted(*hit, -w) == Rgb{})) pdf = light_pdf(scene, from, *hit);
        const double count = 4 * M_PI * pdf;
        expected[bin_of(w)] += count;
        variance[bin_of(w)] += count * count;
    }
    double statistic = 0;
    int n_bins = 0;
    for (std::size_t i = 0; i < kBins; ++i) {
        if (observed[i] + expected[i] < 20) continue;
        statistic +=
            (observed[i] - expected[i]) * (observed[i] - expected[i]) / (expected[i] + variance[i]);
        ++n_bins;
    }
    ASSERT_GT(n_bins, 0);
    const boost::math::chi_squared chi2(n_bins);
    EXPECT_GT(boost::math::cdf(boost::math::complement(chi2, statistic)), level()) << row_.name;
    EXPECT_LT(n_absent, kN);
}

TEST_P(EveryLight, ShowsNothingToPointsBehindIt) {
    if (!scene_.lights()[light_].is_surface() || row_.name == "sphere_from_inside") return;
    for (std::uint32_t i = 0; i < 1000; ++i) {
        Rng rng(37, i, 0);
        // From inside of the sphere and the cylinder, from above the triangle and the disk.
        const bool has_inside = row_.name == "sphere" || row_.name == "cylinder";
        const Vec3 from = has_inside ? Vec3{0.2F, 1, 0} : Vec3{0.1F, 3, 0.2F};
        EXPECT_FALSE(sample_light(scene_, light_, from, light_random(rng)));
    }
}

INSTANTIATE_TEST_SUITE_P(Table, EveryLight, testing::Range(std::size_t{0}, rows().size()),
                         [](const auto& test) { return rows()[test.param].name; });

}  // namespace
}  // namespace misbench
