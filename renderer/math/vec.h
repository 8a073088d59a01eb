// Vectors and colours as plain values. Geometry is float, as in Embree; densities and statistics
// are double and never stored here.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace misbench {

inline constexpr float kPi = 3.14159265358979323846F;

struct Vec2 {
    float x = 0, y = 0;
    bool operator==(const Vec2&) const = default;
};

struct Vec3 {
    float x = 0, y = 0, z = 0;
    bool operator==(const Vec3&) const = default;
};

constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
constexpr Vec3 operator*(float s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
constexpr float dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vec3 cross(Vec3 a, Vec3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
// |a|² of a vector of any finite length.
constexpr double squared_length(Vec3 a) {
    return double{a.x} * double{a.x} + double{a.y} * double{a.y} + double{a.z} * double{a.z};
}
inline float length(Vec3 a) { return std::sqrt(dot(a, a)); }
inline Vec3 normalized(Vec3 a) { return (1.0F / length(a)) * a; }
constexpr Vec3 min(Vec3 a, Vec3 b) {
    return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
constexpr Vec3 max(Vec3 a, Vec3 b) {
    return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
inline float max_abs(Vec3 a) { return std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z)}); }

// Linear RGB: radiance, reflectance or throughput.
struct Rgb {
    float r = 0, g = 0, b = 0;
    bool operator==(const Rgb&) const = default;
    Rgb& operator+=(Rgb o) {
        r += o.r, g += o.g, b += o.b;
        return *this;
    }
    Rgb& operator*=(Rgb o) {
        r *= o.r, g *= o.g, b *= o.b;
        return *this;
    }
};

constexpr Rgb operator+(Rgb a, Rgb b) { return {a.r + b.r, a.g + b.g, a.b + b.b}; }
constexpr Rgb operator-(Rgb a, Rgb b) { return {a.r - b.r, a.g - b.g, a.b - b.b}; }
constexpr Rgb operator*(Rgb a, Rgb b) { return {a.r * b.r, a.g * b.g, a.b * b.b}; }
constexpr Rgb operator*(float s, Rgb a) { return {s * a.r, s * a.g, s * a.b}; }
constexpr Rgb lerp(float t, Rgb a, Rgb b) { return (1 - t) * a + t * b; }
constexpr float max_channel(Rgb a) { return std::max({a.r, a.g, a.b}); }
constexpr float luminance(Rgb a) { return 0.212671F * a.r + 0.715160F * a.g + 0.072169F * a.b; }
inline constexpr Rgb kWhite{1, 1, 1};

// An orthonormal basis with a given z axis [DBC+17].
//
// [DBC+17]  T. Duff et al., Building an orthonormal basis, revisited, 2017.
struct Frame {
    Vec3 x, y, z;

    static Frame from_z(Vec3 n) {
        const float sign = std::copysign(1.0F, n.z);
        const float a = -1.0F / (sign + n.z);
        const float b = n.x * n.y * a;
        return {{1.0F + sign * n.x * n.x * a, sign * b, -sign * n.x},
                {b, sign + n.y * n.y * a, -n.y},
                n};
    }
    Vec3 to_local(Vec3 v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
    Vec3 to_world(Vec3 v) const { return v.x * x + v.y * y + v.z * z; }
};

// An affine map, rows of a 3×4 matrix for column vectors.
struct Transform {
    std::array<std::array<float, 4>, 3> rows{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

    Vec3 direction(Vec3 v) const {
        const auto row = [v](const std::array<float, 4>& r) {
            return r[0] * v.x + r[1] * v.y + r[2] * v.z;
        };
        return {row(rows[0]), row(rows[1]), row(rows[2])};
    }
    Vec3 translation() const { return {rows[0][3], rows[1][3], rows[2][3]}; }
    Vec3 point(Vec3 p) const { return direction(p) + translation(); }
};

}  // namespace misbench
