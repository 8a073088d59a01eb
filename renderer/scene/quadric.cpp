#include "renderer/scene/quadric.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "renderer/base/error.h"

namespace misbench {
namespace {

using std::numbers::pi;
using Double3 = std::array<double, 3>;

// Axes whose lengths differ by no more than this part are of one size: scene files round.
constexpr double kSameScale = 1e-4;

double dot3(const Double3& a, const Double3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Double3 cross3(const Double3& a, const Double3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Double3 axis(const std::array<std::array<double, 4>, 3>& rows, std::size_t column) {
    return {rows[0][column], rows[1][column], rows[2][column]};
}

Vec3 to_float(const Double3& p) {
    return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

double turn_of(double y, double x) {
    const double turn = std::atan2(y, x) / (2 * pi);
    return turn < 0 ? turn + 1 : turn;
}

void check_scale(const Quadric& quadric, const Double3& x, const Double3& y, const Double3& z) {
    const auto fail = [&](const char* reason) {
        throw Error(Errc::InvalidArgument,
                    std::string(name(quadric.shape)) + " '" + quadric.name + "': " + reason);
    };
    const double volume = dot3(cross3(x, y), z);
    if (!(std::abs(volume) > 0) || !std::isfinite(volume)) fail("its transform has no inverse");
    if (quadric.shape == Quadric::Shape::Disk) return;
    const double sx = std::sqrt(dot3(x, x));
    const double sy = std::sqrt(dot3(y, y));
    const double sz = std::sqrt(dot3(z, z));
    const auto differ = [](double a, double b) { return std::abs(a - b) > kSameScale * a; };
    if (differ(sx, sy) || std::abs(dot3(x, y)) > kSameScale * sx * sy ||
        std::abs(dot3(x, z)) > kSameScale * sx * sz ||
        std::abs(dot3(y, z)) > kSameScale * sy * sz ||
        (quadric.shape == Quadric::Shape::Sphere && differ(sx, sz))) {
        fail("its transform scales differently along its axes or shears");
    }
}

}  // namespace

std::string_view name(Quadric::Shape shape) {
    switch (shape) {
        case Quadric::Shape::Sphere:
            return "sphere";
        case Quadric::Shape::Disk:
            return "disk";
        case Quadric::Shape::Cylinder:
            return "cylinder";
    }
    return "";
}

QuadricShape::QuadricShape(const Quadric& quadric)
    : shape_(quadric.shape), flipped_(quadric.flipped) {
    for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t c = 0; c < 4; ++c) to_world_[r][c] = double{quadric.to_world.rows[r][c]};
    }
    const Double3 x = axis(to_world_, 0);
    const Double3 y = axis(to_world_, 1);
    const Double3 z = axis(to_world_, 2);
    const Double3 centre = axis(to_world_, 3);
    check_scale(quadric, x, y, z);
    const double volume = dot3(cross3(x, y), z);
    const std::array<Double3, 3> rows = {cross3(y, z), cross3(z, x), cross3(x, y)};
    for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t c = 0; c < 3; ++c) inverse_[r][c] = rows[r][c] / volume;
        inverse_[r][3] = -dot3(rows[r], centre) / volume;
    }
    const double disk_area = pi * std::sqrt(dot3(rows[2], rows[2]));
    if (shape_ == Quadric::Shape::Sphere) area_ = 4 * disk_area;
    if (shape_ == Quadric::Shape::Disk) area_ = disk_area;
    if (shape_ == Quadric::Shape::Cylinder) {
        area_ = 2 * pi * std::sqrt(dot3(x, x)) * std::sqrt(dot3(z, z));
    }

    // A round cross-section reaches as far along a world axis as its two local axes together.
    Double3 lower{};
    Double3 upper{};
    for (std::size_t r = 0; r < 3; ++r) {
        const double reach = shape_ == Quadric::Shape::Sphere ? std::hypot(x[r], y[r], z[r])
                                                              : std::hypot(x[r], y[r]);
        const double end = shape_ == Quadric::Shape::Cylinder ? z[r] : 0;
        const double slack = 1e-6 * (reach + std::abs(end) + std::abs(centre[r]));
        lower[r] = centre[r] + std::min(0.0, end) - reach - slack;
        upper[r] = centre[r] + std::max(0.0, end) + reach + slack;
    }
    lower_ = to_float(lower);
    upper_ = to_float(upper);
}

Double3 QuadricShape::to_local(Vec3 p, double w) const {
    const auto row = [&](const std::array<double, 4>& r) {
        return r[0] * double{p.x} + r[1] * double{p.y} + r[2] * double{p.z} + r[3] * w;
    };
    return {row(inverse_[0]), row(inverse_[1]), row(inverse_[2])};
}

std::optional<float> QuadricShape::intersect(Vec3 origin, Vec3 direction, float t_near,
                                             float t_far) const {
    const Double3 o = to_local(origin, 1);
    const Double3 d = to_local(direction, 0);
    const auto inside_range = [&](double t) { return t > double{t_near} && t < double{t_far}; };
    if (shape_ == Quadric::Shape::Disk) {
        if (d[2] == 0) return std::nullopt;
        const double t = -o[2] / d[2];
        const double x = o[0] + t * d[0];
        const double y = o[1] + t * d[1];
        if (!inside_range(t) || x * x + y * y > 1) return std::nullopt;
        return static_cast<float>(t);
    }
    // |o + t d| = 1, for a cylinder without z. The distance of the line from the centre decides;
    // it is taken from the line's closest point, where nothing cancels.
    const bool is_sphere = shape_ == Quadric::Shape::Sphere;
    const double wz = is_sphere ? 1 : 0;
    const double a = d[0] * d[0] + d[1] * d[1] + wz * d[2] * d[2];
    if (a == 0) return std::nullopt;
    const double middle = -(o[0] * d[0] + o[1] * d[1] + wz * o[2] * d[2]) / a;
    const Double3 closest = {o[0] + middle * d[0], o[1] + middle * d[1],
                             wz * (o[2] + middle * d[2])};
    const double left = 1 - dot3(closest, closest);
    if (left < 0) return std::nullopt;
    const double half = std::sqrt(left / a);
    for (const double t : {middle - half, middle + half}) {
        if (!inside_range(t)) continue;
        const double z = o[2] + t * d[2];
        if (is_sphere || (z >= 0 && z <= 1)) return static_cast<float>(t);
    }
    return std::nullopt;
}

QuadricShape::Point QuadricShape::from_local(Double3 p) const {
    Point point;
    Double3 normal = p;
    double u = turn_of(p[1], p[0]);
    double v = 0;
    if (shape_ == Quadric::Shape::Sphere) {
        v = std::atan2(std::hypot(p[0], p[1]), p[2]) / pi;
    } else if (shape_ == Quadric::Shape::Disk) {
        v = u;
        u = std::hypot(p[0], p[1]);
        normal = {0, 0, 1};
    } else {
        v = p[2];
        normal[2] = 0;
    }
    // Normals turn with the inverse transposed.
    Double3 world_normal{};
    Double3 world{};
    for (std::size_t r = 0; r < 3; ++r) {
        world_normal[r] =
            normal[0] * inverse_[0][r] + normal[1] * inverse_[1][r] + normal[2] * inverse_[2][r];
        world[r] = to_world_[r][0] * p[0] + to_world_[r][1] * p[1] + to_world_[r][2] * p[2] +
                   to_world_[r][3];
    }
    const double size = (flipped_ ? -1 : 1) * std::sqrt(dot3(world_normal, world_normal));
    point.position = to_float(world);
    point.normal =
        to_float({world_normal[0] / size, world_normal[1] / size, world_normal[2] / size});
    point.uv = {static_cast<float>(u), static_cast<float>(v)};
    // All before the last rounding was double.
    point.error = 2 * std::numeric_limits<float>::epsilon() * max_abs(point.position);
    return point;
}

QuadricShape::Point QuadricShape::at(Vec3 position) const {
    Double3 p = to_local(position, 1);
    if (shape_ == Quadric::Shape::Disk) {
        p[2] = 0;
    } else {
        const double z = shape_ == Quadric::Shape::Sphere ? p[2] : 0;
        const double radius = std::sqrt(p[0] * p[0] + p[1] * p[1] + z * z);
        p[0] /= radius;
        p[1] /= radius;
        if (shape_ == Quadric::Shape::Sphere) p[2] /= radius;
    }
    return from_local(p);
}

QuadricShape::Point QuadricShape::sample(Vec2 u) const {
    const double phi = 2 * pi * double{u.y};
    const double t = double{u.x};
    if (shape_ == Quadric::Shape::Disk) {
        const double radius = std::sqrt(t);
        return from_local({radius * std::cos(phi), radius * std::sin(phi), 0});
    }
    if (shape_ == Quadric::Shape::Cylinder) return from_local({std::cos(phi), std::sin(phi), t});
    const double z = 1 - 2 * t;
    const double radius = std::sqrt(std::max(0.0, (1 - z) * (1 + z)));
    return from_local({radius * std::cos(phi), radius * std::sin(phi), z});
}

// 1 - cos of the half angle of the cone around a sphere, without cancellation; 0 where the position
// is not outside.
double QuadricShape::one_minus_cos_of_cone(Vec3 from) const {
    if (shape_ != Quadric::Shape::Sphere) return 0;
    const Double3 p = to_local(from, 1);
    const double d2 = dot3(p, p);
    if (d2 <= 1) return 0;
    const double sin2 = 1 / d2;
    return sin2 / (1 + std::sqrt(1 - sin2));
}

std::optional<double> QuadricShape::cone_pdf_solid_angle(Vec3 from) const {
    const double one_minus_cos = one_minus_cos_of_cone(from);
    if (one_minus_cos == 0) return std::nullopt;
    return 1 / (2 * pi * one_minus_cos);
}

std::optional<QuadricShape::Cone> QuadricShape::sample_cone(Vec3 from, Vec2 u) const {
    const double one_minus_cos = one_minus_cos_of_cone(from);
    if (one_minus_cos == 0) return std::nullopt;
    // In the sphere's frame, where its radius is 1: a direction at angle θ from the centre meets
    // the sphere at `distance`. The frame is a rotation and a scale, so angles are the world's.
    const Double3 p = to_local(from, 1);
    const double d = std::sqrt(dot3(p, p));
    const Double3 z = {-p[0] / d, -p[1] / d, -p[2] / d};
    const Double3 helper = std::abs(z[0]) < 0.5 ? Double3{1, 0, 0} : Double3{0, 1, 0};
    Double3 x = cross3(z, helper);
    const double x_size = std::sqrt(dot3(x, x));
    for (double& c : x) c /= x_size;
    const Double3 y = cross3(z, x);
    const double below = double{u.x} * one_minus_cos;  // 1 - cos θ
    const double cos_theta = 1 - below;
    const double sin2 = below * (2 - below);
    const double sin_theta = std::sqrt(sin2);
    const double distance = d * cos_theta - std::sqrt(std::max(0.0, 1 - d * d * sin2));
    const double phi = 2 * pi * double{u.y};
    Double3 hit{};
    for (std::size_t i = 0; i < 3; ++i) {
        hit[i] = p[i] + distance * (sin_theta * (std::cos(phi) * x[i] + std::sin(phi) * y[i]) +
                                    cos_theta * z[i]);
    }
    const double radius = std::sqrt(dot3(hit, hit));
    for (double& c : hit) c /= radius;
    return Cone{from_local(hit), 1 / (2 * pi * one_minus_cos)};
}

}  // namespace misbench
