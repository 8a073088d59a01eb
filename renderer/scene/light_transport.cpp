#include "renderer/scene/light_transport.h"

#include "renderer/base/check.h"
#include "renderer/math/warp.h"

namespace misbench {
namespace {

SurfacePoint point_in_space(Vec3 position, std::uint32_t light) {
    SurfacePoint point;
    point.position = position;
    point.light = light;
    return point;
}

// A point on a surface light uniformly by area.
SurfacePoint sample_by_area(const Scene& scene, const Light& light, Vec2 u) {
    if (light.shape == Light::Shape::Triangle) {
        return scene.point_on(light.index, warp_triangle(u));
    }
    return scene.point_on_quadric(light.index, scene.quadrics()[light.index].sample(u));
}

float spot_falloff(const SpotLight& spot, Vec3 w) {
    // atan2 keeps the angle exact near the axis, where acos loses half of its digits.
    const float angle = std::atan2(length(cross(spot.direction, w)), dot(spot.direction, w));
    if (angle <= spot.beam_width) return 1;
    if (angle >= spot.cutoff_angle) return 0;
    return (spot.cutoff_angle - angle) / (spot.cutoff_angle - spot.beam_width);
}

double one_minus_cos(float angle) {
    const double half = std::sin(0.5 * double{angle});
    return 2 * half * half;
}

// ∫ falloff dω over the cone.
double spot_solid_angle(const SpotLight& spot) {
    const double b = double{spot.beam_width};
    const double c = double{spot.cutoff_angle};
    if (!(c > b)) return 2 * M_PI * one_minus_cos(spot.cutoff_angle);
    return 2 * M_PI * (1 - (std::sin(c) - std::sin(b)) / (c - b));
}

std::optional<LightEnd> sample_surface(const Scene& scene, std::uint32_t index, Vec3 from, Vec2 u) {
    const Light& light = scene.lights()[index];
    LightEnd end;
    end.light = index;
    if (light.shape == Light::Shape::Quadric) {
        if (const auto cone = scene.quadrics()[light.index].sample_cone(from, u)) {
            end.point = scene.point_on_quadric(light.index, cone->point);
            end.pdf = cone->pdf_solid_angle;
        }
    }
    if (end.pdf == 0) end.point = sample_by_area(scene, light, u);
    const Vec3 edge = end.point.position - from;
    if (dot(end.point.normal, edge) == 0) return std::nullopt;
    end.wi = normalized(edge);
    end.radiance = scene.emitted(end.point, -end.wi);
    if (end.radiance == Rgb{}) return std::nullopt;
    if (end.pdf == 0) end.pdf = area_to_solid_angle(1 / double{light.area}, from, end.point);
    return end;
}

// A point or spot light: I / d² arrives.
std::optional<LightEnd> sample_point_in_space(const Scene& scene, std::uint32_t index, Vec3 from) {
    const Light& light = scene.lights()[index];
    const bool is_spot = light.shape == Light::Shape::Spot;
    const Vec3 position =
        is_spot ? scene.spot_light(light).position : scene.point_light(light).position;
    const Vec3 edge = position - from;
    const float d2 = dot(edge, edge);
    if (d2 == 0) return std::nullopt;
    LightEnd end{.light = index, .is_delta = true, .point = point_in_space(position, index)};
    end.wi = normalized(edge);
    const float falloff = is_spot ? spot_falloff(scene.spot_light(light), -end.wi) : 1;
    if (falloff == 0) return std::nullopt;
    end.radiance = (falloff / d2) * light.emission;
    end.pdf = 1;
    return end;
}

// A start on the disk across w through which all light of this direction enters the scene.
SurfacePoint point_on_entry_disk(const Scene& scene, std::uint32_t light, Vec3 w, Vec2 u) {
    const Frame frame = Frame::from_z(w);
    const float r = scene.radius() * std::sqrt(u.x);
    const float phi = 2 * kPi * u.y;
    SurfacePoint point =
        point_in_space(scene.center() + r * (std::cos(phi) * frame.x + std::sin(phi) * frame.y) -
                           scene.radius() * w,
                       light);
    point.normal = w;
    point.shading_normal = w;
    return point;
}

double entry_disk_area(const Scene& scene) {
    return M_PI * double{scene.radius()} * double{scene.radius()};
}

}  // namespace

std::optional<LightEnd> sample_light(const Scene& scene, std::uint32_t index, Vec3 from,
                                     LightRandom random) {
    const Light& light = scene.lights()[index];
    switch (light.shape) {
        case Light::Shape::Triangle:
        case Light::Shape::Quadric:
            return sample_surface(scene, index, from, random.u);
        case Light::Shape::Point:
        case Light::Shape::Spot:
            return sample_point_in_space(scene, index, from);
        case Light::Shape::Directional:
            return LightEnd{.light = index,
                            .is_infinite = true,
                            .is_delta = true,
                            .wi = -scene.directional_light(light).direction,
                            .radiance = light.emission,
                            .pdf = 1};
        case Light::Shape::Environment: {
            const Environment::Sample sample =
                scene.environment()->sample(random.row(), random.column());
            return LightEnd{.light = index,
                            .is_infinite = true,
                            .wi = sample.w,
                            .radiance = sample.radiance,
                            .pdf = sample.pdf};
        }
    }
    return std::nullopt;
}

bool visible(const Scene& scene, const SurfacePoint& from, const LightEnd& light) {
    if (light.is_infinite) return scene.visible_to_infinity(from, light.wi);
    if (light.is_delta) return scene.visible(from, light.point.position);
    return scene.visible(from, light.point);
}

double light_pdf(const Scene& scene, Vec3 from, const SurfacePoint& on_light) {
    const Light& light = scene.lights()[on_light.light];
    if (light.shape == Light::Shape::Quadric) {
        if (const auto pdf = scene.quadrics()[light.index].cone_pdf_solid_angle(from)) return *pdf;
    }
    return area_to_solid_angle(1 / double{light.area}, from, on_light);
}

double light_pdf_area(const Scene& scene, Vec3 from, const SurfacePoint& on_light) {
    const Light& light = scene.lights()[on_light.light];
    if (light.shape == Light::Shape::Quadric) {
        if (const auto pdf = scene.quadrics()[light.index].cone_pdf_solid_angle(from)) {
            return solid_angle_to_area(*pdf, from, on_light);
        }
    }
    return 1 / double{light.area};
}

std::optional<LightEmission> sample_emission(const Scene& scene, std::uint32_t index,
                                             Vec2 u_position, LightRandom direction) {
    const Light& light = scene.lights()[index];
    LightEmission start;
    start.emission = light.emission;
    switch (light.shape) {
        case Light::Shape::Triangle:
        case Light::Shape::Quadric: {
            start.point = sample_by_area(scene, light, u_position);
            const Vec3 local = warp_cosine_hemisphere(direction.u);
            if (local.z <= 0) return std::nullopt;
            start.w = Frame::from_z(start.point.normal).to_world(local);
            start.emission = scene.emitted(start.point, start.w);
            break;
        }
        case Light::Shape::Point:
            start.point = point_in_space(scene.point_light(light).position, index);
            start.w = warp_sphere(direction.u);
            start.point.normal = start.w;
            break;
        case Light::Shape::Spot: {
            const SpotLight& spot = scene.spot_light(light);
            start.point = point_in_space(spot.position, index);
            start.w = Frame::from_z(spot.direction)
                          .to_world(warp_cap(one_minus_cos(spot.cutoff_angle), direction.u));
            start.point.normal = start.w;
            start.emission = spot_falloff(spot, start.w) * light.emission;
            break;
        }
        case Light::Shape::Directional:
            start.w = scene.directional_light(light).direction;
            start.point = point_on_entry_disk(scene, index, start.w, u_position);
            break;
        case Light::Shape::Environment: {
            const Environment::Sample sample =
                scene.environment()->sample(direction.row(), direction.column());
            start.w = -sample.w;
            start.point = point_on_entry_disk(scene, index, start.w, u_position);
            start.emission = sample.radiance;
            break;
        }
    }
    if (start.emission == Rgb{}) return std::nullopt;
    const EmissionPdf pdf = emission_pdf(scene, index, start.point, start.w);
    start.pdf_position = pdf.position;
    start.pdf_direction = pdf.direction;
    if (!(pdf.position > 0 && pdf.direction > 0)) return std::nullopt;
    return start;
}

EmissionPdf emission_pdf(const Scene& scene, std::uint32_t index, const SurfacePoint& point,
                         Vec3 w) {
    const Light& light = scene.lights()[index];
    switch (light.shape) {
        case Light::Shape::Triangle:
        case Light::Shape::Quadric:
            return {1 / double{light.area},
                    double{density_cosine_hemisphere(dot(point.normal, w))}};
        case Light::Shape::Point:
            return {1, 1 / (4 * M_PI)};
        case Light::Shape::Spot: {
            const SpotLight& spot = scene.spot_light(light);
            return {1, spot_falloff(spot, w) == 0
                           ? 0
                           : 1 / (2 * M_PI * one_minus_cos(spot.cutoff_angle))};
        }
        case Light::Shape::Directional:
            return {1 / entry_disk_area(scene), 1};
        case Light::Shape::Environment:
            return {1 / entry_disk_area(scene), scene.environment()->pdf(-w)};
    }
    return {};
}

Rgb light_power(const Scene& scene, std::uint32_t index) {
    const Light& light = scene.lights()[index];
    switch (light.shape) {
        case Light::Shape::Triangle:
        case Light::Shape::Quadric:
            return (kPi * light.area) * light.emission;
        case Light::Shape::Point:
            return (4 * kPi) * light.emission;
        case Light::Shape::Spot:
            return static_cast<float>(spot_solid_angle(scene.spot_light(light))) * light.emission;
        case Light::Shape::Directional:
            return static_cast<float>(entry_disk_area(scene)) * light.emission;
        case Light::Shape::Environment:
            return static_cast<float>(entry_disk_area(scene)) * scene.environment()->total();
    }
    return {};
}

namespace {

LightBounds bounds_of(const Scene& scene, std::uint32_t index) {
    const Light& light = scene.lights()[index];
    LightBounds bounds;
    bounds.is_infinite = light.is_infinite();
    if (light.is_surface()) {
        bounds.area = double{light.area};
        // In π W without a product by π, so that triangles of equal area × radiance stay equal.
        bounds.power = double{light.area} * double{luminance(light.emission)};
    } else {
        bounds.power = double{luminance(light_power(scene, index))} / M_PI;
    }
    if (light.shape == Light::Shape::Triangle) {
        const auto [i0, i1, i2] = scene.triangles()[light.index];
        const Vec3 a = scene.vertices()[i0];
        const Vec3 b = scene.vertices()[i1];
        const Vec3 c = scene.vertices()[i2];
        bounds.lower = min(min(a, b), c);
        bounds.upper = max(max(a, b), c);
        bounds.axis = scene.point_on(light.index, {1.0F / 3, 1.0F / 3}).normal;
        bounds.cos_normals = 1;
        // Corner normals on both sides of the face: parts of it look one way, parts the other.
        for (const Vec2 corner : {Vec2{0, 0}, Vec2{1, 0}, Vec2{0, 1}}) {
            if (dot(scene.point_on(light.index, corner).normal, bounds.axis) < 0) {
                bounds.cos_normals = -1;
            }
        }
    } else if (light.shape == Light::Shape::Quadric) {
        const QuadricShape& quadric = scene.quadrics()[light.index];
        bounds.lower = quadric.lower();
        bounds.upper = quadric.upper();
        bounds.cos_normals = quadric.cos_normal_spread();
        bounds.axis = quadric.sample({0, 0}).normal;
    } else if (light.shape == Light::Shape::Point) {
        bounds.lower = bounds.upper = scene.point_light(light).position;
    } else if (light.shape == Light::Shape::Spot) {
        const SpotLight& spot = scene.spot_light(light);
        bounds.lower = bounds.upper = spot.position;
        bounds.axis = spot.direction;
        bounds.cos_normals = 1;
        bounds.cos_emission = std::cos(spot.cutoff_angle);
    }
    return bounds;
}

}  // namespace

std::vector<LightBounds> light_bounds(const Scene& scene) {
    std::vector<LightBounds> bounds;
    for (std::uint32_t i = 0; i < scene.lights().size(); ++i) bounds.push_back(bounds_of(scene, i));
    return bounds;
}

}  // namespace misbench
