#include "renderer/scene/mitsuba/transform.h"

#include <cmath>

#include "renderer/scene/mitsuba/object.h"

namespace misbench::mitsuba {
namespace {

// Scene files round their matrices to six digits or so.
constexpr float kTolerance = 1e-3F;

struct Axis {
    double x, y, z;
};

// Rodrigues' rotation about an axis, in double so that a right angle stays one.
Transform rotation(Axis axis, double degrees) {
    const double size = std::sqrt(axis.x * axis.x + axis.y * axis.y + axis.z * axis.z);
    const auto [x, y, z] = Axis{axis.x / size, axis.y / size, axis.z / size};
    const double radians = degrees * 3.14159265358979323846 / 180;
    const double s = std::sin(radians), c = std::cos(radians), t = 1 - c;
    const auto f = [](double value) { return static_cast<float>(value); };
    Transform result;
    result.rows[0] = {f(t * x * x + c), f(t * x * y - s * z), f(t * x * z + s * y), 0};
    result.rows[1] = {f(t * x * y + s * z), f(t * y * y + c), f(t * y * z - s * x), 0};
    result.rows[2] = {f(t * x * z - s * y), f(t * y * z + s * x), f(t * z * z + c), 0};
    return result;
}

Transform matrix(const Property& operation) {
    const std::vector<double> m = operation.numbers();
    if (m.size() != 16 && m.size() != 9) {
        operation.fail("expected 16 or 9 numbers, found " + std::to_string(m.size()));
    }
    const std::size_t width = m.size() == 16 ? 4 : 3;
    Transform result;
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t i = 0; i < width; ++i) {
            result.rows[row][i] = static_cast<float>(m[row * width + i]);
        }
    }
    if (width == 4 && !(m[12] == 0 && m[13] == 0 && m[14] == 0 && m[15] == 1)) {
        operation.fail("the last row of a matrix must be 0 0 0 1");
    }
    return result;
}

Vec3 triple(const Property& operation, const char* attribute) {
    const std::vector<double> v = operation.numbers(attribute);
    if (v.size() != 3) operation.fail(std::string("expected three numbers in '") + attribute + "'");
    return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

// Mitsuba's frame: z towards the target, x to the left.
Transform look_at(const Property& operation) {
    const Vec3 origin = triple(operation, "origin");
    const Vec3 forward = triple(operation, "target") - origin;
    const Vec3 left = cross(triple(operation, "up"), forward);
    if (!(length(left) > 0)) operation.fail("'up' lies along the direction of view");
    const Vec3 z = normalized(forward);
    const Vec3 x = normalized(left);
    return from_columns(x, cross(z, x), z, origin);
}

Transform operation_of(const Property& operation) {
    if (operation.type == "translate") return translation(operation.vec3(0));
    if (operation.type == "scale") return scaling(operation.vec3(1));
    if (operation.type == "matrix") return matrix(operation);
    if (operation.type == "lookat") return look_at(operation);
    const Vec3 axis = operation.vec3(0);
    if (!(length(axis) > 0)) operation.fail("the axis has no direction");
    return rotation({double{axis.x}, double{axis.y}, double{axis.z}}, operation.number("angle"));
}

}  // namespace

Transform compose(const Transform& second, const Transform& first) {
    Transform result;
    for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t c = 0; c < 4; ++c) {
            double sum = c == 3 ? double{second.rows[r][3]} : 0;
            for (std::size_t k = 0; k < 3; ++k) {
                sum += double{second.rows[r][k]} * double{first.rows[k][c]};
            }
            result.rows[r][c] = static_cast<float>(sum);
        }
    }
    return result;
}

Transform translation(Vec3 by) { return from_columns({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, by); }

Transform scaling(Vec3 by) { return from_columns({by.x, 0, 0}, {0, by.y, 0}, {0, 0, by.z}, {}); }

Transform from_columns(Vec3 x, Vec3 y, Vec3 z, Vec3 origin) {
    Transform result;
    result.rows[0] = {x.x, y.x, z.x, origin.x};
    result.rows[1] = {x.y, y.y, z.y, origin.y};
    result.rows[2] = {x.z, y.z, z.z, origin.z};
    return result;
}

Vec3 column(const Transform& transform, std::size_t i) {
    return {transform.rows[0][i], transform.rows[1][i], transform.rows[2][i]};
}

double determinant(const Transform& transform) {
    const auto& [x, y, z] = transform.rows;
    const auto minor_of = [](double a, double b, double c, double d) { return a * d - b * c; };
    return double{x[0]} * minor_of(double{y[1]}, double{y[2]}, double{z[1]}, double{z[2]}) -
           double{x[1]} * minor_of(double{y[0]}, double{y[2]}, double{z[0]}, double{z[2]}) +
           double{x[2]} * minor_of(double{y[0]}, double{y[1]}, double{z[0]}, double{z[1]});
}

Vec3 map_normal(const Transform& transform, Vec3 n) {
    // The inverse transposed is the matrix of cofactors over the determinant, whose size does not
    // matter here.
    const Vec3 a = column(transform, 0), b = column(transform, 1), c = column(transform, 2);
    const Vec3 mapped = n.x * cross(b, c) + n.y * cross(c, a) + n.z * cross(a, b);
    const float size = length(mapped);
    if (!(std::isfinite(size) && size > 0)) return {};
    return ((determinant(transform) < 0 ? -1 : 1) / size) * mapped;
}

bool at_right_angles(const Transform& transform, std::size_t i, std::size_t j) {
    const Vec3 a = column(transform, i), b = column(transform, j);
    return std::abs(dot(a, b)) <= kTolerance * length(a) * length(b);
}

bool same_length(const Transform& transform, std::size_t i, std::size_t j) {
    const float a = length(column(transform, i)), b = length(column(transform, j));
    return std::abs(a - b) <= kTolerance * std::max(a, b);
}

bool is_orthonormal(const Transform& transform) {
    for (std::size_t i = 0; i < 3; ++i) {
        if (std::abs(length(column(transform, i)) - 1) > kTolerance) return false;
        if (!at_right_angles(transform, i, (i + 1) % 3)) return false;
    }
    return true;
}

Transform read_transform(const Property& property) {
    Transform result;
    for (const Property& operation : property.operations) {
        result = compose(operation_of(operation), result);
    }
    return result;
}

}  // namespace misbench::mitsuba
