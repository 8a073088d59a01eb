// Spheres, disks and cylinders with exact intersections, in double: `Quadric` (description.h) made
// ready for rays.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "renderer/math/vec.h"
#include "renderer/scene/description.h"

namespace misbench {

// "sphere", "disk" or "cylinder".
std::string_view name(Quadric::Shape shape);

class QuadricShape {
 public:
    // Throws InvalidArgument when the map cannot be inverted, or scales a sphere or a cylinder's
    // cross-section differently along its axes.
    explicit QuadricShape(const Quadric& quadric);

    // A box that contains it, rounding included.
    Vec3 lower() const { return lower_; }
    Vec3 upper() const { return upper_; }
    float area() const { return static_cast<float>(area_); }
    Quadric::Shape shape() const { return shape_; }

    // The smallest t in (t_near, t_far) with origin + t direction on the surface.
    std::optional<float> intersect(Vec3 origin, Vec3 direction, float t_near, float t_far) const;

    struct Point {
        Vec3 position;
        Vec3 normal;  // unit, on the side it looks to
        Vec2 uv;
        float error = 0;  // |position - the surface| is at most this
    };
    // The surface point closest, up to second order, to a position near the surface.
    Point at(Vec3 position) const;
    // Uniform by area: density 1 / area().
    Point sample(Vec2 u) const;
    // A direction through the surface as seen from a position: uniform by solid angle in the cone
    // around a sphere that does not contain the position, otherwise absent: sample() by area then.
    struct Cone {
        Point point;
        double pdf_solid_angle = 0;
    };
    std::optional<Cone> sample_cone(Vec3 from, Vec2 u) const;
    std::optional<double> cone_pdf_solid_angle(Vec3 from) const;
    // The angle between the axis (z of its frame) and its normals is at most acos of this.
    float cos_normal_spread() const { return shape_ == Quadric::Shape::Disk ? 1.0F : -1.0F; }

 private:
    using Double3 = std::array<double, 3>;
    Double3 to_local(Vec3 p, double w) const;
    Point from_local(Double3 p) const;
    double one_minus_cos_of_cone(Vec3 from) const;

    Quadric::Shape shape_;
    std::array<std::array<double, 4>, 3> to_world_{};
    std::array<std::array<double, 4>, 3> inverse_{};
    bool flipped_;
    double area_ = 0;
    Vec3 lower_;
    Vec3 upper_;
};

}  // namespace misbench
