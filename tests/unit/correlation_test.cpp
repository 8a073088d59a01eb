// Factors of samples that share a prefix, by densities alone: each against its equations, vertex by
// vertex, in numbers that do not underflow.
//
// [PRDD15]  S. Popov, R. Ramamoorthi, F. Durand, G. Drettakis, Probabilistic connections for
//           bidirectional path tracing, 2015.
// [Jen19]   J. Jendersie, Variance reduction via footprint estimation in the presence of path
//           reuse, 2019.
#include "renderer/weights/correlation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "renderer/base/error.h"
#include "renderer/methods/render_loop.h"
#include "renderer/weights/jendersie.h"
#include "renderer/weights/popov.h"
#include "tests/support/random_paths.h"
#include "tests/support/scenes.h"

namespace misbench {
namespace {

using test::LongProduct;
using test::RandomPaths;

enum class End : std::uint8_t { Surface, Environment, PointLight, DirectionalLight };
constexpr std::array kEnds = {End::Surface, End::Environment, End::PointLight,
                              End::DirectionalLight};

const Scene& furnace() {
    static const Scene scene(test::furnace(DiffuseMaterial{}, {1, 1, 1}), 1);
    return scene;
}

// A path with all that factors look at: densities, numbers of samples, where the camera and x_1
// are, what kind of light is at its end.
struct Path : test::WeighedPath {
    Vec3 x_0{};
    Vec3 x_1{};
    End end = End::Surface;

    bool is_infinite() const { return end == End::Environment || end == End::DirectionalLight; }
    bool is_delta_light() const { return end == End::PointLight || end == End::DirectionalLight; }

    std::vector<double> factors(const FactorProvider& provider) const {
        std::vector<PathVertex> camera(static_cast<std::size_t>(n()) - 1);
        camera[0].point.position = x_1;
        LightVertex light;
        light.is_infinite = is_infinite();
        light.is_delta_light = is_delta_light();
        // A camera path that runs into a surface has no light's subpath.
        if (end == End::Surface) camera.emplace_back();
        const PathView view = {.densities = &densities,
                               .origin = x_0,
                               .camera = camera,
                               .light = {&light, end == End::Surface ? 0U : 1U}};
        std::vector<double> factors(static_cast<std::size_t>(n_techniques(n())), 1);
        provider.multiply(view, counts, factors);
        return factors;
    }
};

// Also a path whose prefix and rest are so unlikely that only LongProduct holds them.
Path random_path(RandomPaths& random, int i) {
    const int n = i % 40 == 0 ? 300 : 2 + i % 30;
    const double decades = i % 3 == 0 ? 1 : i % 3 == 1 ? 5 : 80;
    Path path{{random.path(n, decades, 0.1 / n, 2.0 / n)}};
    path.counts = random.counts();
    path.end = kEnds[static_cast<std::size_t>(i) % kEnds.size()];
    if (path.is_delta_light()) path.densities.from_camera[static_cast<std::size_t>(n)] = 0;
    const auto coordinate = [&] { return static_cast<float>(random.magnitude(1)); };
    path.x_0 = {coordinate(), coordinate(), coordinate()};
    path.x_1 = {-coordinate(), coordinate(), coordinate()};
    return path;
}

// The vertex' probability to be within the disk again.                [grittmann2021 Eq. 16]
double chance(double density, double measure) { return std::min(1.0, density * measure); }

// c_t = max(P(y) / P(x), 1/n_t) with P(x) = P(y) + P(z) - P(y) P(z).  [grittmann2021 Eq. 13, 15]
double by_equations(const LongProduct& y, const LongProduct& z, double n_t, bool bounded) {
    long double c = 1;
    if (z.significand != 0) {
        c = y.significand == 0 ? 0 : 1 / (1 + z.over(y) - z.over(LongProduct{}));
    }
    return std::max(static_cast<double>(c), bounded ? 1 / n_t : 0);
}

// Technique by technique, all products made anew.
std::vector<double> by_equations(const Path& path, const CorrelationParameters& parameters) {
    constexpr double kDegree = M_PI / 180;
    const int n = path.n();
    const double d = std::sqrt(squared_length(path.x_1 - path.x_0));
    const double unit =
        parameters.radius == "global" ? double{furnace().radius()} : d * std::tan(kDegree);
    const double area = M_PI * std::pow(parameters.scale * unit, 2);  // [grittmann2021 Eq. 17]
    // A direction to a light far outside is as exact as what the camera sees of the disk; that a
    // light without extent is chosen again is a probability.
    double at_light = area;
    if (path.is_infinite()) at_light = area / (d * d);
    if (path.is_delta_light()) at_light = 1;
    // A delta lobe leads into any disk again: its density is infinite there.
    const auto step = [&](double density, bool after_delta) {
        return after_delta ? (density > 0 ? 1 : 0) : chance(density, area);
    };

    const auto prefix = [&](int k) {
        LongProduct p;
        for (int i = 1; i <= k; ++i)
            p.multiply(step(path.camera(i), i > 1 && path.is_delta(i - 1)));
        return p;
    };
    std::vector<double> factors(static_cast<std::size_t>(n_techniques(n)), 1);
    if (path.counts.nee > 1) {
        LongProduct rest;
        rest.multiply(chance(path.densities.next_event, at_light));
        factors[1] = by_equations(prefix(n - 1), rest, path.counts.nee, parameters.bounded);
    }
    for (int k = 1; k < n && path.counts.merge > 1; ++k) {
        LongProduct rest;
        rest.multiply(chance(path.light(n), at_light));
        for (int i = k; i < n; ++i) {
            rest.multiply(step(path.light(i), i + 1 < n && path.is_delta(i + 1)));
        }
        factors[static_cast<std::size_t>(n + k)] =
            by_equations(prefix(k), rest, path.counts.merge, parameters.bounded);
    }
    return factors;
}

void expect_near(const std::vector<double>& a, const std::vector<double>& b, double tolerance,
                 const Path& path) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t t = 0; t < a.size(); ++t) {
        ASSERT_NEAR(a[t], b[t], tolerance * b[t] + 1e-299)
            << "technique " << t << " of " << path.n() << " edges";
    }
}

TEST(Correlation, IsThatOfItsEquations) {
    for (const bool bounded : {true, false}) {
        for (const std::string radius : {"distance", "global"}) {
            for (const double scale : {1.0, 0.1, 30.0}) {
                const CorrelationParameters parameters{radius, scale, bounded};
                const auto correlation = make_correlation(parameters);
                correlation->start(furnace(), {});
                RandomPaths random(31);
                for (int i = 0; i < 600; ++i) {
                    const Path path = random_path(random, i);
                    ASSERT_NO_FATAL_FAILURE(expect_near(
                        path.factors(*correlation), by_equations(path, parameters), 1e-9, path));
                }
            }
        }
    }
}

TEST(Correlation, LiesBetweenOneSampleAndAll) {
    RandomPaths random(32);
    const auto bounded = make_correlation({});
    const auto free = make_correlation({.bounded = false});
    for (int i = 0; i < 2000; ++i) {
        const Path path = random_path(random, i);
        const std::vector<double> factors = path.factors(*bounded);
        for (int t = 0; t < n_techniques(path.n()); ++t) {
            const Technique technique = technique_at(t, path.n());
            const bool is_merge = technique.kind == TechniqueKind::Merge;
            const bool is_nee = technique.kind == TechniqueKind::NextEvent;
            const double n_t = is_merge ? path.counts.merge : is_nee ? path.counts.nee : 1;
            const double c = factors[static_cast<std::size_t>(t)];
            ASSERT_LE(c, 1);
            ASSERT_GE(c, n_t > 1 ? 1 / n_t : 1);
        }
        for (const double c : path.factors(*free)) {
            ASSERT_GT(c, 0);
            ASSERT_LE(c, 1);
        }
    }
}

// What the camera sees in a pixel is a point: many samples of such a prefix are independent.
TEST(Correlation, IsOneBehindAPrefixThatIsCertain) {
    RandomPaths random(33);
    const auto correlation = make_correlation({});
    Path path = random_path(random, 4);
    path.counts = {.nee = 16, .merge = 1e6, .merge_first = true};
    path.densities.from_camera[1] = 1e12;
    EXPECT_EQ(path.factors(*correlation)[static_cast<std::size_t>(path.n()) + 1], 1);
    path.densities.n_edges = 2;
    EXPECT_EQ(path.factors(*correlation)[1], 1);
}

Path scaled(Path path, float s) {
    const double s2 = double{s} * double{s};
    const auto n = static_cast<std::size_t>(path.n());
    for (std::size_t i = 1; i <= n; ++i) {
        // All are over areas, of a delta lobe too: the probability per disk around the vertex.
        if (i < n || path.end == End::Surface) {
            path.densities.from_camera[i] /= s2;
            path.densities.from_light[i] /= s2;
        }
    }
    if (path.end == End::Surface) path.densities.next_event /= s2;
    path.densities.merge_area *= s2;
    path.x_0 = s * path.x_0;
    path.x_1 = s * path.x_1;
    return path;
}

TEST(Correlation, DoesNotDependOnTheUnitOfLength) {
    RandomPaths random(34);
    for (const double scale : {1.0, 20.0}) {
        const auto correlation = make_correlation({.scale = scale});
        for (int i = 0; i < 1000; ++i) {
            const Path path = random_path(random, i);
            for (const float s : {1e-3F, 0.5F, 1e3F}) {
                ASSERT_NO_FATAL_FAILURE(expect_near(scaled(path, s).factors(*correlation),
                                                    path.factors(*correlation), 1e-4, path))
                    << s;
            }
        }
    }
}

// The box with a glass ball and a mirror, all lengths times s, of which powers of two leave every
// number's digits as they are.
SceneDescription glass_in_a_box(float s) {
    SceneDescription scene = test::open_box();
    scene.meshes.push_back(test::ceiling_lamp());
    scene.materials.push_back(test::surface(DielectricMaterial({})));
    scene.materials.push_back(test::surface(ConductorMaterial({})));
    scene.quadrics.push_back(test::ball({-0.4F, -0.55F, 0.1F}, 0.4F, 3));
    scene.quadrics.push_back(test::ball({0.45F, -0.6F, -0.2F}, 0.35F, 4));
    for (Mesh& mesh : scene.meshes) {
        for (Vec3& position : mesh.positions) position = s * position;
    }
    for (Quadric& quadric : scene.quadrics) {
        for (auto& row : quadric.to_world.rows) {
            for (float& value : row) value *= s;
        }
    }
    scene.camera.to_world.rows[2][3] *= s;
    return scene;
}

// Sums over the samples of a render, of factors' logarithms.
class FactorSums final : public SampleObserver {
 public:
    void start_phase(std::size_t n_chunks) override { sums_.assign(n_chunks, 0); }
    void observe(const Sample& sample, std::size_t chunk) override {
        if (sample.q.empty()) return;
        for (std::size_t t = 0; t < sample.factors.size(); ++t) {
            if (sample.q[t] > 1e-3) sums_[chunk] += std::log(sample.factors[t]);
        }
    }
    void finish_phase() override {
        for (const double sum : sums_) sum_ += sum;
    }
    double sum() const { return sum_; }

 private:
    std::vector<double> sums_;
    double sum_ = 0;
};

double factors_in_glass(float s, const std::string& factors) {
    const Scene scene(glass_in_a_box(s), 1);
    FactorSums sums;
    const RenderResult result = render(scene, {.method = "vcm",
                                               .parameters = {{"factors", factors}},
                                               .width = 24,
                                               .height = 24,
                                               .budget = SampleBudget{1},
                                               .seed = 3,
                                               .observer = &sums});
    EXPECT_TRUE(result.valid);
    return sums.sum();
}

TEST(Correlation, OfTracedPathsThroughGlassDoesNotDependOnTheUnitOfLength) {
    const double one = factors_in_glass(1, "correlation");
    EXPECT_LT(one, -100);
    for (const float s : {0x1p-6F, 0x1p6F}) {
        EXPECT_NEAR(factors_in_glass(s, "correlation"), one, -1e-3 * one) << s;
    }
}

TEST(Correlation, RefusesWhatCannotBe) {
    EXPECT_THROW((CorrelationParameters{.radius = "pixel"}.check()), ParameterError);
    for (const double scale : {0.0, -1.0, 1e7, std::nan("")}) {
        EXPECT_THROW((CorrelationParameters{.scale = scale}.check()), ParameterError) << scale;
    }
    EXPECT_NO_THROW((CorrelationParameters{"global", 1e6, false}.check()));
}

TEST(Popov, CountsSamplesOfOnePrefixAsOne) {
    RandomPaths random(35);
    const auto popov = make_popov();
    for (int i = 0; i < 500; ++i) {
        const Path path = random_path(random, i);
        std::vector<double> expected(static_cast<std::size_t>(n_techniques(path.n())), 1);
        expected[1] = 1 / std::max(path.counts.nee, 1.0);
        for (int k = 1; k < path.n(); ++k) {
            expected[static_cast<std::size_t>(path.n() + k)] = 1 / std::max(path.counts.merge, 1.0);
        }
        ASSERT_NO_FATAL_FAILURE(expect_near(path.factors(*popov), expected, 1e-12, path));
    }
}

// c = (f_c^e + f_l^e) / (n f_c^e + f_l^e), e = 4.5                                    [Jen19]
std::vector<double> footprint_factors(const Path& path) {
    const int n = path.n();
    std::vector<double> factors(static_cast<std::size_t>(n_techniques(n)), 1);
    const auto footprint = [](double density) { return 1 / (0.01L + std::sqrt(density)); };
    for (int k = 1; k < n && path.counts.merge > 1; ++k) {
        long double camera = 0;
        for (int i = 1; i <= k; ++i) {
            if (i == 1 || !path.is_delta(i - 1)) camera += footprint(path.camera(i));
        }
        long double light = path.is_delta_light() ? 0 : footprint(path.light(n));
        for (int i = k; i < n; ++i) {
            if (i + 1 == n || !path.is_delta(i + 1)) light += footprint(path.light(i));
        }
        const long double ratio = std::pow(light / camera, 4.5L);
        factors[static_cast<std::size_t>(n + k)] =
            static_cast<double>(std::isinf(ratio) ? 1 : (1 + ratio) / (path.counts.merge + ratio));
    }
    return factors;
}

TEST(Jendersie, IsThatOfBothFootprints) {
    RandomPaths random(36);
    const auto jendersie = make_jendersie();
    for (int i = 0; i < 3000; ++i) {
        const Path path = random_path(random, i);
        const std::vector<double> factors = path.factors(*jendersie);
        ASSERT_NO_FATAL_FAILURE(expect_near(factors, footprint_factors(path), 1e-9, path));
        for (const double c : factors) {
            ASSERT_GT(c, 0);
            ASSERT_LE(c, 1);
        }
    }
}

}  // namespace
}  // namespace misbench
