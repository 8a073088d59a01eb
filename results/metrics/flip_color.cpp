#include "results/metrics/flip_color.h"

#include <cmath>
#include <cstddef>

namespace misbench {
namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

// Linear sRGB (primaries of Rec. 709, white D65) to XYZ, as [And20]'s authors have it.
constexpr Matrix kXyzOfRgb{
    {{10135552.0 / 24577794.0, 8788810.0 / 24577794.0, 4435075.0 / 24577794.0},
     {2613072.0 / 12288897.0, 8788810.0 / 12288897.0, 887015.0 / 12288897.0},
     {1425312.0 / 73733382.0, 8788810.0 / 73733382.0, 70074185.0 / 73733382.0}}};

// Each row over the white's coordinate, which is the row's sum.
constexpr Matrix over_white(Matrix m) {
    for (auto& row : m) {
        const double white = row[0] + row[1] + row[2];
        for (double& value : row) value /= white;
    }
    return m;
}

constexpr Matrix inverse(const Matrix& m) {
    Matrix adjugate{};
    for (std::size_t r = 0; r < 3; ++r) {
        const auto& p = m[(r + 1) % 3];
        const auto& q = m[(r + 2) % 3];
        for (std::size_t c = 0; c < 3; ++c) {
            adjugate[c][r] = p[(c + 1) % 3] * q[(c + 2) % 3] - p[(c + 2) % 3] * q[(c + 1) % 3];
        }
    }
    const double determinant =
        m[0][0] * adjugate[0][0] + m[0][1] * adjugate[1][0] + m[0][2] * adjugate[2][0];
    for (auto& row : adjugate) {
        for (double& value : row) value /= determinant;
    }
    return adjugate;
}

using FloatMatrix = std::array<std::array<float, 3>, 3>;

constexpr FloatMatrix rounded(const Matrix& m) {
    FloatMatrix result{};
    for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t c = 0; c < 3; ++c) result[r][c] = static_cast<float>(m[r][c]);
    }
    return result;
}

constexpr FloatMatrix kFromRgb = rounded(over_white(kXyzOfRgb));
constexpr FloatMatrix kToRgb = rounded(inverse(over_white(kXyzOfRgb)));

FlipColor product(const FloatMatrix& m, const FlipColor& v) {
    return {m[0][0] * v[0] + m[0][1] * v[1] + m[0][2] * v[2],
            m[1][0] * v[0] + m[1][1] * v[1] + m[1][2] * v[2],
            m[2][0] * v[0] + m[2][1] * v[1] + m[2][2] * v[2]};
}

// CIE 1976: the cube root, and its tangent where that is steep.
float lab_curve(float t) {
    constexpr float kDelta = 6.0F / 29.0F;
    return t > kDelta * kDelta * kDelta ? std::cbrt(t)
                                        : t / (3.0F * kDelta * kDelta) + 4.0F / 29.0F;
}

}  // namespace

FlipColor xyz_from_linear_rgb(const FlipColor& rgb) { return product(kFromRgb, rgb); }

FlipColor linear_rgb_from_xyz(const FlipColor& xyz) { return product(kToRgb, xyz); }

FlipColor ycxcz_from_xyz(const FlipColor& xyz) {
    return {116.0F * xyz[1] - 16.0F, 500.0F * (xyz[0] - xyz[1]), 200.0F * (xyz[1] - xyz[2])};
}

FlipColor xyz_from_ycxcz(const FlipColor& ycxcz) {
    const float y = (ycxcz[0] + 16.0F) / 116.0F;
    return {y + ycxcz[1] / 500.0F, y, y - ycxcz[2] / 200.0F};
}

FlipColor lab_from_xyz(const FlipColor& xyz) {
    return ycxcz_from_xyz({lab_curve(xyz[0]), lab_curve(xyz[1]), lab_curve(xyz[2])});
}

FlipColor hunt_adjusted(const FlipColor& lab) {
    const float scale = 0.01F * lab[0];
    return {lab[0], scale * lab[1], scale * lab[2]};
}

float hyab(const FlipColor& a, const FlipColor& b) {
    const float da = a[1] - b[1];
    const float db = a[2] - b[2];
    return std::abs(a[0] - b[0]) + std::sqrt(da * da + db * db);
}

}  // namespace misbench
