// A perspective camera with square pixels, through a pinhole or a thin lens; pixel (0, 0) is top
// left. A pixel's value is the mean of the radiance over its area and the lens.
//
// Film points are in pixels of the image from its top left corner.
#pragma once

#include <optional>

#include "renderer/embree/accelerator.h"
#include "renderer/scene/description.h"

namespace misbench {

class Camera {
 public:
    Camera(const PerspectiveCamera& camera, int width, int height);

    bool has_lens() const { return lens_radius_ > 0; }

    // The ray through a film point from the lens point for `lens` in [0, 1)², uniform on the lens
    // (which a pinhole ignores); unit direction.
    Ray ray(Vec2 film, Vec2 lens) const {
        const Vec3 pinhole = {film_to_plane_x_ * film.x + plane_x0_,
                              film_to_plane_y_ * film.y + plane_y0_, -1};
        if (!has_lens()) return {position_, normalized(to_world(pinhole))};
        const Vec3 start = lens_point(lens);
        return {position_ + to_world(start), normalized(to_world(focus_ * pinhole - start))};
    }

    // A point seen through a point of the lens.
    struct View {
        Vec2 film;      // inside of the image
        Vec3 position;  // on the lens
        Vec3 w;         // unit, from there to the point seen
        // Importance per pixel over the density of the lens point, 1/sr: what arrives from -w with
        // radiance L adds L · importance · (solid angle) to the pixel. Equal to pdf_direction().
        double importance = 0;
    };
    // Absent where the image does not show the point. `lens` as for ray().
    std::optional<View> view(Vec3 point, Vec2 lens) const;

    // Density of ray() choosing direction w from its point on the lens, with the film point uniform
    // in a pixel: solid angle measure, per pixel. w is unit and within the image.
    double pdf_direction(Vec3 w) const;

 private:
    Vec3 to_world(Vec3 local) const { return local.x * x_ + local.y * y_ + local.z * z_; }
    Vec3 lens_point(Vec2 u) const;

    Vec3 position_;
    Vec3 x_, y_, z_;  // unit: right, up, backwards
    float lens_radius_;
    float focus_;
    float width_;
    float height_;
    // From film points to the plane one unit before the camera.
    float film_to_plane_x_ = 0;
    float film_to_plane_y_ = 0;
    float plane_x0_ = 0;
    float plane_y0_ = 0;
};

}  // namespace misbench
