// Every camera: the rays it makes, the points it sees and their densities. A new kind of camera is
// a row of rows().
#include "renderer/scene/camera.h"

#include <gtest/gtest.h>

#include <cmath>

#include "renderer/base/rng.h"
#include "tests/support/statistics.h"

namespace misbench {
namespace {

constexpr double kAlpha = 0.01;
constexpr int kWidth = 12;
constexpr int kHeight = 8;

struct Row {
    std::string name;
    PerspectiveCamera camera;
    double half_width;  // of the image, one unit before the camera, of its middle
    double half_height;
    double middle_x = 0;
    double middle_y = 0;
};

const std::vector<Row>& rows() {
    static const std::vector<Row> kRows = [] {
        using Axis = PerspectiveCamera::FovAxis;
        const double t = std::tan(25 * M_PI / 180);
        std::vector<Row> all;
        const auto add = [&](const char* name, Axis axis, double w, double h) -> Row& {
            all.push_back({.name = name,
                           .camera = {.fov_degrees = 50, .fov_axis = axis},
                           .half_width = w,
                           .half_height = h});
            return all.back();
        };
        add("vertical", Axis::Vertical, 1.5 * t, t);
        add("horizontal", Axis::Horizontal, t, t / 1.5);
        add("smaller", Axis::Smaller, 1.5 * t, t);
        add("larger", Axis::Larger, t, t / 1.5);
        const double d = t / std::hypot(1.5, 1);
        add("diagonal", Axis::Diagonal, 1.5 * d, d);
        // A window of half the width and a quarter of the height: the film is 24 × 32.
        Row& window = add("window", Axis::Vertical, 0.5 * 0.75 * t, 0.25 * t);
        window.camera.window = {.x0 = 0.5F, .y0 = 0.25F, .x1 = 1, .y1 = 0.5F};
        window.middle_x = 0.5 * 0.75 * t;
        window.middle_y = 0.25 * t;
        Row& lens = add("thin_lens", Axis::Vertical, 1.5 * t, t);
        lens.camera.lens_radius = 0.3F;
        lens.camera.focus_distance = 2.5F;
        Row& turned = add("turned_and_scaled", Axis::Vertical, 1.5 * t, t);
        turned.camera.to_world.rows = {{{0, 0, -3, 1}, {0, 3, 0, 2}, {3, 0, 0, 3}}};
        return all;
    }();
    return kRows;
}

class EveryCamera : public testing::TestWithParam<std::size_t> {
 protected:
    const Row& row_ = rows()[GetParam()];
    const Camera camera_{row_.camera, kWidth, kHeight};
    Vec3 axis(std::size_t c) const {
        const auto& m = row_.camera.to_world.rows;
        return normalized({m[0][c], m[1][c], m[2][c]});
    }
};

TEST_P(EveryCamera, SeesWhatItsRaysMeet) {
    for (std::uint32_t i = 0; i < 1000; ++i) {
        Rng rng(41, i, 0);
        const Vec2 film = {static_cast<float>(kWidth) * rng.uniform(),
                           static_cast<float>(kHeight) * rng.uniform()};
        const Vec2 lens = {rng.uniform(), rng.uniform()};
        const Ray ray = camera_.ray(film, lens);
        const float distance = 0.5F + 10 * rng.uniform();
        const auto view = camera_.view(ray.origin + distance * ray.direction, lens);
        // A point within rounding of the border may fall outside.
        if (!view) {
            EXPECT_LT(std::min({film.x, film.y, kWidth - film.x, kHeight - film.y}), 1e-3F);
            continue;
        }
        EXPECT_NEAR(view->film.x, film.x, 2e-4F);
        EXPECT_NEAR(view->film.y, film.y, 2e-4F);
        EXPECT_NEAR(dot(view->w, ray.direction), 1, 1e-6F);
        EXPECT_NEAR(view->importance / camera_.pdf_direction(ray.direction), 1, 1e-4);
    }
}

TEST_P(EveryCamera, HasTheFieldOfViewThatItSays) {
    if (camera_.has_lens()) return;
    const Vec3 middle = camera_.ray({kWidth / 2.0F, kHeight / 2.0F}, {}).direction;
    const Vec3 corner = camera_.ray({0, 0}, {}).direction;
    const float ahead = -dot(axis(2), middle);
    EXPECT_NEAR(dot(axis(0), middle) / ahead, row_.middle_x, 1e-5);
    EXPECT_NEAR(dot(axis(1), middle) / ahead, row_.middle_y, 1e-5);
    const float ahead_corner = -dot(axis(2), corner);
    EXPECT_NEAR(dot(axis(0), corner) / ahead_corner, row_.middle_x - row_.half_width, 1e-5);
    EXPECT_NEAR(dot(axis(1), corner) / ahead_corner, row_.middle_y + row_.half_height, 1e-5);
}

// The mean of 1/p over rays of density p (per pixel) is the solid angle of a pixel.
TEST_P(EveryCamera, HasTheDensityThatItSays) {
    if (camera_.has_lens()) return;
    std::vector<double> inverses;
    for (std::uint32_t i = 0; i < 50'000; ++i) {
        Rng rng(42, i, 0);
        const Vec2 film = {static_cast<float>(kWidth) * rng.uniform(),
                           static_cast<float>(kHeight) * rng.uniform()};
        inverses.push_back(kWidth * kHeight /
                           camera_.pdf_direction(camera_.ray(film, {}).direction));
    }
    // The solid angle between the corners (x, y) of a plane at distance 1 is a sum of
    // atan(x y / √(1 + x² + y²)).
    const auto corner = [](double x, double y) {
        return std::atan(x * y / std::sqrt(1 + x * x + y * y));
    };
    const double x0 = row_.middle_x - row_.half_width;
    const double x1 = row_.middle_x + row_.half_width;
    const double y0 = row_.middle_y - row_.half_height;
    const double y1 = row_.middle_y + row_.half_height;
    const double expected = corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0);
    EXPECT_GT(test::p_value_of_mean(inverses, expected),
              test::sidak(kAlpha, 2 * static_cast<int>(rows().size())))
        << row_.name;
}

// Splats from the points of a glowing sphere make the image that rays make of it.
TEST_P(EveryCamera, SplatsTheImageThatItsRaysSee) {
    const Vec3 position = row_.camera.to_world.translation();
    // A small disk across the middle of the image, out of focus.
    const Vec3 middle = camera_.ray({kWidth / 2.0F, kHeight / 2.0F}, {}).direction;
    const Vec3 ahead = camera_.has_lens() ? -axis(2) : middle;
    const Vec3 centre = position + 4 * ahead;
    const Frame frame = Frame::from_z(-ahead);
    constexpr float kRadius = 0.4F;
    std::vector<double> differences;
    for (std::uint32_t i = 0; i < 200'000; ++i) {
        Rng rng(43, i, 0);
        const float r = kRadius * std::sqrt(rng.uniform());
        const float phi = 2 * kPi * rng.uniform();
        const Vec3 point = centre + r * std::cos(phi) * frame.x + r * std::sin(phi) * frame.y;
        const auto view = camera_.view(point, {rng.uniform(), rng.uniform()});
        double splat = 0;
        if (view && view->film.x < kWidth / 2.0F) {
            const Vec3 edge = point - view->position;
            splat = view->importance * double{-dot(frame.z, view->w)} / double{dot(edge, edge)} *
                    M_PI * double{kRadius} * double{kRadius};
        }
        Rng other(44, i, 0);
        const Vec2 film = {static_cast<float>(kWidth) / 2 * other.uniform(),
                           static_cast<float>(kHeight) * other.uniform()};
        const Ray ray = camera_.ray(film, {other.uniform(), other.uniform()});
        const float t = dot(frame.z, centre - ray.origin) / dot(frame.z, ray.direction);
        const Vec3 meets = ray.origin + t * ray.direction - centre;
        const double seen = dot(meets, meets) < kRadius * kRadius ? kWidth * kHeight / 2.0 : 0;
        differences.push_back(100 + splat - seen);
    }
    EXPECT_GT(test::p_value_of_mean(differences, 100),
              test::sidak(kAlpha, 2 * static_cast<int>(rows().size())))
        << row_.name;
}

INSTANTIATE_TEST_SUITE_P(Table, EveryCamera, testing::Range(std::size_t{0}, rows().size()),
                         [](const auto& test) { return rows()[test.param].name; });

}  // namespace
}  // namespace misbench
