#include "renderer/scene/camera.h"

#include <cmath>

namespace misbench {
namespace {

Vec3 column(const Transform& transform, std::size_t c) {
    return {transform.rows[0][c], transform.rows[1][c], transform.rows[2][c]};
}

// Half the extent of the whole film, one unit before the camera; aspect is its width over height.
Vec2 half_film(const PerspectiveCamera& camera, float aspect) {
    const float t = std::tan(camera.fov_degrees * kPi / 360);
    const Vec2 vertical = {t * aspect, t};
    const Vec2 horizontal = {t, t / aspect};
    switch (camera.fov_axis) {
        case PerspectiveCamera::FovAxis::Vertical:
            return vertical;
        case PerspectiveCamera::FovAxis::Horizontal:
            return horizontal;
        case PerspectiveCamera::FovAxis::Smaller:
            return aspect >= 1 ? vertical : horizontal;
        case PerspectiveCamera::FovAxis::Larger:
            return aspect >= 1 ? horizontal : vertical;
        case PerspectiveCamera::FovAxis::Diagonal: {
            const float height = t / std::sqrt(1 + aspect * aspect);
            return {height * aspect, height};
        }
    }
    return vertical;
}

}  // namespace

Camera::Camera(const PerspectiveCamera& camera, int width, int height)
    : position_(camera.to_world.translation()),
      x_(normalized(column(camera.to_world, 0))),
      y_(normalized(column(camera.to_world, 1))),
      z_(normalized(column(camera.to_world, 2))),
      lens_radius_(camera.lens_radius),
      focus_(camera.focus_distance),
      width_(static_cast<float>(width)),
      height_(static_cast<float>(height)) {
    const PerspectiveCamera::Window& window = camera.window;
    const float part_x = window.x1 - window.x0;
    const float part_y = window.y1 - window.y0;
    const float aspect = (width_ / part_x) / (height_ / part_y);
    const Vec2 half = half_film(camera, aspect);
    film_to_plane_x_ = 2 * half.x * part_x / width_;
    film_to_plane_y_ = -2 * half.y * part_y / height_;
    plane_x0_ = (2 * window.x0 - 1) * half.x;
    plane_y0_ = (1 - 2 * window.y0) * half.y;
}

Vec3 Camera::lens_point(Vec2 u) const {
    const float r = lens_radius_ * std::sqrt(u.x);
    const float phi = 2 * kPi * u.y;
    return {r * std::cos(phi), r * std::sin(phi), 0};
}

std::optional<Camera::View> Camera::view(Vec3 point, Vec2 lens) const {
    const Vec3 start = has_lens() ? lens_point(lens) : Vec3{};
    View view;
    view.position = position_ + to_world(start);
    const Vec3 edge = point - view.position;
    const Vec3 local = {dot(x_, edge), dot(y_, edge), dot(z_, edge)};
    if (!(local.z < 0)) return std::nullopt;
    // Where the ray from the lens point meets the plane in focus is where the pinhole sees it.
    const float reach = has_lens() ? focus_ / -local.z : 1 / -local.z;
    const float unit = has_lens() ? 1 / focus_ : 1;
    const float plane_x = unit * (start.x + reach * local.x);
    const float plane_y = unit * (start.y + reach * local.y);
    view.film = {(plane_x - plane_x0_) / film_to_plane_x_,
                 (plane_y - plane_y0_) / film_to_plane_y_};
    if (!(view.film.x >= 0 && view.film.x < width_ && view.film.y >= 0 && view.film.y < height_)) {
        return std::nullopt;
    }
    view.w = normalized(edge);
    view.importance = pdf_direction(view.w);
    return view;
}

// A pixel covers A = |film_to_plane_x · film_to_plane_y| of the plane one unit before the camera;
// dA = dω / cos³θ.
double Camera::pdf_direction(Vec3 w) const {
    const double cos_theta = -double{dot(z_, w)};
    const double pixel_area = std::abs(double{film_to_plane_x_} * double{film_to_plane_y_});
    return 1 / (pixel_area * cos_theta * cos_theta * cos_theta);
}

}  // namespace misbench
