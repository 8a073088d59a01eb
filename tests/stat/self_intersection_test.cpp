// Where rays start and shadow segments end: over scales, distances from the origin and shapes, a
// surface is never in the way of its own light, and no gap wider than a few roundings is missed.
#include <gtest/gtest.h>

#include <random>

#include "experiments/extremes/extreme_scenes.h"
#include "renderer/scene/scene.h"

namespace misbench {
namespace {

constexpr float kEpsilon = 0x1p-23F;

struct Double3 {
    double x, y, z;
};
Double3 operator+(Double3 a, Double3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Double3 operator-(Double3 a, Double3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Double3 operator*(double s, Double3 a) { return {s * a.x, s * a.y, s * a.z}; }
double dot(Double3 a, Double3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Double3 cross(Double3 a, Double3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Double3 normalized(Double3 a) { return 1 / std::sqrt(dot(a, a)) * a; }
Double3 exact(Vec3 a) { return {double{a.x}, double{a.y}, double{a.z}}; }
Vec3 rounded(Double3 a) {
    return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
}

struct Shape {
    const char* name;
    double length, width;
    bool axis_aligned = false;
    // Shadow segments and rays that may meet their own surface, of a million. Above an aspect of
    // 300 the offset is less than its bound.
    double allowed = 0;
};
constexpr Shape kShapes[] = {
    {"square", 1, 1},        {"aligned square", 1, 1, true},      {"large and thin", 100, 0.1},
    {"sliver 1e4", 1, 1e-4}, {"sliver 1e6", 1, 1e-6, false, 200},
};
constexpr double kScales[] = {1e-6, 1, 1e6};
constexpr double kDistances[] = {0, 1, 100, 1e5};  // of the centre from the origin, in scales
constexpr int kParallelograms = 30;
constexpr int kRays = 100;

class Random {
 public:
    explicit Random(unsigned seed) : generator_(seed) {}
    double uniform() { return std::uniform_real_distribution<double>()(generator_); }
    Double3 direction() {
        std::normal_distribution<double> normal;
        return normalized(Double3{normal(generator_), normal(generator_), normal(generator_)});
    }

 private:
    std::mt19937_64 generator_;
};

// Two triangles that share an edge and, up to the rounding of their corners, a plane.
struct Parallelogram {
    Vec3 corner, u_end, opposite, v_end;

    Double3 normal() const {
        return normalized(cross(exact(u_end) - exact(corner), exact(v_end) - exact(corner)));
    }
    Double3 point(double u, double v) const {
        return exact(corner) + u * (exact(u_end) - exact(corner)) +
               v * (exact(v_end) - exact(corner));
    }
    Mesh mesh() const {
        Mesh mesh;
        mesh.positions = {corner, u_end, opposite, v_end};
        mesh.triangles = {{0, 1, 3}, {1, 2, 3}};
        return mesh;
    }
    // Whether a point is on one side of both triangles' planes.
    bool faces(Double3 p, double side) const {
        const Double3 other = cross(exact(opposite) - exact(u_end), exact(v_end) - exact(u_end));
        return side * dot(p - exact(corner), normal()) > 0 &&
               side * dot(p - exact(u_end), other) > 0;
    }
};

Parallelogram parallelogram(const Shape& shape, double scale, double distance, Random& random) {
    Double3 u = random.direction();
    Double3 v = normalized(cross(u, random.direction()));
    if (shape.axis_aligned) u = {1, 0, 0}, v = {0, 0, 1};
    const Double3 centre = scale * distance * random.direction();
    u = scale * shape.length * u;
    v = scale * shape.width * v + (shape.axis_aligned ? 0 : random.uniform() - 0.5) * u;
    const Double3 corner = centre - 0.5 * (u + v);
    return {rounded(corner), rounded(corner + u), rounded(corner + u + v), rounded(corner + v)};
}

Scene scene_of(std::vector<Mesh> meshes) {
    SceneDescription description;
    description.materials = {
        {.name = "", .front = {.layer = {.material = DiffuseMaterial{kWhite}}}}};
    description.meshes = std::move(meshes);
    return Scene(std::move(description), 1);
}

// A direction over the surface on either side; every third one grazes it.
Double3 leaving(const Parallelogram& p, int i, Random& random) {
    const Double3 w = random.direction();
    if (i % 3 != 0) return w;
    const Double3 n = p.normal();
    const double height = dot(w, n);
    const double grazing = std::pow(10, -5 * random.uniform());
    return normalized(normalized(w - height * n) + (height < 0 ? -grazing : grazing) * n);
}

// visit(scene, parallelogram, hit, i, random) for points that rays hit, over all cases of a shape.
template <class Visit>
void for_each_hit(const Shape& shape, const Visit& visit) {
    Random random(17);
    for (const double scale : kScales) {
        for (const double distance : kDistances) {
            for (int k = 0; k < kParallelograms; ++k) {
                const Parallelogram p = parallelogram(shape, scale, distance, random);
                const Scene scene = scene_of({p.mesh()});
                for (int i = 0; i < kRays; ++i) {
                    const Double3 target = p.point(random.uniform(), random.uniform());
                    const Double3 w = random.direction();
                    const auto hit =
                        scene.closest({rounded(target + 3 * scale * w), rounded(-1.0 * w)});
                    if (hit) visit(scene, p, *hit, i, scale, random);
                }
            }
        }
    }
}

void PrintTo(const Shape& shape, std::ostream* out) { *out << shape.name; }

class EveryShape : public testing::TestWithParam<Shape> {};

TEST_P(EveryShape, IsHitAtPointsWithinTheirOffsetOfIt) {
    double worst = 0;
    for_each_hit(GetParam(), [&](const Scene&, const Parallelogram& p, const SurfacePoint& hit, int,
                                 double, Random&) {
        // The point lies on one of the two triangles.
        const Double3 other =
            normalized(cross(exact(p.opposite) - exact(p.u_end), exact(p.v_end) - exact(p.u_end)));
        const double off =
            std::min(std::abs(dot(exact(hit.position) - exact(p.corner), p.normal())),
                     std::abs(dot(exact(hit.position) - exact(p.u_end), other)));
        worst = std::max(worst, off / double{hit.offset});
    });
    EXPECT_LT(worst, 1);
}

TEST_P(EveryShape, IsNotMetAgainByRaysThatLeaveIt) {
    int n = 0;
    int met = 0;
    for_each_hit(GetParam(), [&](const Scene& scene, const Parallelogram& p,
                                 const SurfacePoint& hit, int i, double, Random& random) {
        const Double3 w = leaving(p, i, random);
        const double side = dot(w, p.normal()) < 0 ? -1 : 1;
        // Where the corners' rounding bends the parallelogram, its halves may see each other.
        if (!p.faces(exact(hit.position) + 1e30 * w, side)) return;
        ++n;
        met += scene.closest({hit.leave(rounded(w)), rounded(w)}) ? 1 : 0;
    });
    EXPECT_GT(n, 1000);
    EXPECT_LE(met, 1e-6 * GetParam().allowed * n) << "of " << n;
}

// From points at all distances; the point is on the shape, whose own triangles may not hide it.
TEST_P(EveryShape, DoesNotHideItsOwnPointsFromAfar) {
    int n = 0;
    int hidden = 0;
    for_each_hit(GetParam(), [&](const Scene& scene, const Parallelogram& p,
                                 const SurfacePoint& hit, int i, double scale, Random& random) {
        const Double3 w = leaving(p, i, random);
        SurfacePoint viewer;
        viewer.position =
            rounded(exact(hit.position) + scale * std::pow(10, 4 * random.uniform() - 1) * w);
        viewer.normal = rounded(-1.0 * w);
        const double side = dot(w, p.normal()) < 0 ? -1 : 1;
        if (!p.faces(exact(viewer.position), side)) return;
        // Nearer to the plane than this, float does not tell its sides apart.
        const Double3 edge = exact(viewer.position) - exact(hit.position);
        const double resolved =
            16 * double{kEpsilon} * (double{max_abs(hit.position)} + std::sqrt(dot(edge, edge)));
        if (std::abs(dot(edge, p.normal())) < resolved) return;
        ++n;
        hidden += scene.visible(viewer, hit) ? 0 : 1;
    });
    EXPECT_GT(n, 1000);
    EXPECT_LE(hidden, 1e-6 * GetParam().allowed * n) << "of " << n;
}

INSTANTIATE_TEST_SUITE_P(All, EveryShape, testing::ValuesIn(kShapes), [](const auto& test) {
    std::string name = test.param.name;
    for (char& c : name) c = c == ' ' ? '_' : c;
    return name;
});

// Two parallel unit squares with a gap, at a height: what leaves one must meet the other.
TEST(Gap, IsSeenWhenItIsWiderThanFourRoundingsOfAnAlignedCoordinate) {
    for (const float height : {0.0F, 1.0F, 100.0F, 1e5F}) {
        const float gap = 4 * kEpsilon * std::max(height, 1.0F);
        const auto square = [](float y) {
            return extremes::grid({-0.5F, y, -0.5F}, {0, 0, 1}, {1, 0, 0}, 1, 1, 0);
        };
        const Scene scene = scene_of({square(height), square(height + gap)});
        const auto lower = scene.closest({{0.1F, height - 1 - height / 4, 0.2F}, {0, 1, 0}});
        ASSERT_TRUE(lower);
        ASSERT_EQ(lower->position.y, height);
        const Vec3 up = misbench::normalized({0.3F, 1, -0.2F});
        const auto upper = scene.closest({lower->leave(up), up});
        ASSERT_TRUE(upper) << height;
        EXPECT_EQ(upper->position.y, height + gap);
        EXPECT_LT(lower->offset, gap) << height;
    }
}

TEST(Gap, IsSeenWhenItIsWiderThanSixtyFourRoundingsOfATurnedSurface) {
    Random random(5);
    for (int i = 0; i < 200; ++i) {
        const Parallelogram p = parallelogram({"", 1, 1}, 1, 0.5, random);
        const Double3 n = p.normal();
        const double gap = 64 * double{kEpsilon};
        const auto moved = [&](Vec3 corner) { return rounded(exact(corner) + gap * n); };
        const Parallelogram above{moved(p.corner), moved(p.u_end), moved(p.opposite),
                                  moved(p.v_end)};
        const Scene scene = scene_of({p.mesh(), above.mesh()});
        const auto lower = scene.closest({rounded(p.point(0.4, 0.3) - n), rounded(n)});
        ASSERT_TRUE(lower);
        EXPECT_TRUE(scene.closest({lower->leave(rounded(n)), rounded(n)}));
    }
}

}  // namespace
}  // namespace misbench
