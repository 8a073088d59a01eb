// A pinhole camera with square pixels; pixel (0, 0) is top left.
#pragma once

#include "renderer/embree/accelerator.h"
#include "renderer/scene/description.h"

namespace misbench {

class Camera {
 public:
    Camera(const PerspectiveCamera& camera, int width, int height)
        : to_world_(camera.to_world),
          tan_half_fov_(std::tan(camera.vertical_fov_degrees * kPi / 360)),
          width_(static_cast<float>(width)),
          height_(static_cast<float>(height)) {}

    // The ray through a point of the film, in pixels from the top left corner; unit direction.
    Ray ray(Vec2 film) const {
        const float x = (2 * film.x / width_ - 1) * tan_half_fov_ * width_ / height_;
        const float y = (1 - 2 * film.y / height_) * tan_half_fov_;
        return {to_world_.translation(), normalized(to_world_.direction({x, y, -1}))};
    }

 private:
    Transform to_world_;
    float tan_half_fov_;
    float width_;
    float height_;
};

}  // namespace misbench
