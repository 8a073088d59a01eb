// What light transport asks of a light: a sample towards a point, the emission of a path, and the
// densities of both for any point and direction.
#pragma once

#include <optional>

#include "renderer/math/warp.h"
#include "renderer/scene/light_sampler.h"
#include "renderer/scene/scene.h"

namespace misbench {

// Where a next event meets a light: a point on a surface, a point in space, or a direction.
struct LightEnd {
    std::uint32_t light = 0;
    bool is_infinite = false;  // `point` means nothing: the light comes from direction wi
    bool is_delta = false;     // no other technique finds it; `pdf` is 1
    SurfacePoint point{};      // of a point in space, only the position
    Vec3 wi{};                 // unit, from the reference point towards the light
    // Radiance that arrives along wi; of a delta light the irradiance across wi that arrives.
    Rgb radiance{};
    double pdf = 0;  // solid angle measure at the reference point, > 0, given the light
};

// Random numbers in [0, 1) of 24 bits, as Rng gives them, and 24 more of each for lights that need
// them.
struct LightRandom {
    Vec2 u;
    Vec2 finer{};

    double row() const { return double{u.x} + 0x1p-24 * double{finer.x}; }
    double column() const { return double{u.y} + 0x1p-24 * double{finer.y}; }
};
// Whether the finer part is looked at.
inline bool needs_finer(const Light& light) { return light.shape == Light::Shape::Environment; }

// A point or direction of one light, seen from a position. Visibility is not tested.
// Absent where the sample carries nothing: seen from behind, edge-on, outside of a spot's cone.
std::optional<LightEnd> sample_light(const Scene& scene, std::uint32_t light, Vec3 from,
                                     LightRandom random);

// The same for a light that is known to be a triangle.
inline std::optional<LightEnd> sample_triangle_light(const Scene& scene, std::uint32_t index,
                                                     Vec3 from, Vec2 u) {
    const Light& light = scene.lights()[index];
    std::optional<LightEnd> end;
    end.emplace();
    end->light = index;
    end->point = scene.point_on(light.index, warp_triangle(u));
    const Vec3 edge = end->point.position - from;
    if (dot(end->point.normal, edge) == 0) return std::nullopt;
    end->wi = normalized(edge);
    end->radiance = scene.emitted(end->point, -end->wi);
    if (end->radiance == Rgb{}) return std::nullopt;
    end->pdf = area_to_solid_angle(1 / double{light.area}, from, end->point);
    return end;
}

// Whether nothing lies between a surface point and what sample_light() found from there.
bool visible(const Scene& scene, const SurfacePoint& from, const LightEnd& light);

// Of sample_light(from) finding a point on a light's surface; solid angle measure.
double light_pdf(const Scene& scene, Vec3 from, const SurfacePoint& on_light);
// The same in area measure: finite also where the light is seen edge-on.
double light_pdf_area(const Scene& scene, Vec3 from, const SurfacePoint& on_light);

// The start of a light's path. Its flux through pdf_position and pdf_direction is
// emission · |cos| / (pdf_position · pdf_direction), with |cos| at point.normal.
struct LightEmission {
    // On the light; of a light in space only the position; of an infinite one a point of a disk
    // across w that the scene's bounding sphere fits through, just outside of it.
    SurfacePoint point;
    Vec3 w;                    // unit, where the light travels to
    Rgb emission;              // radiance, intensity of a point or spot light, or irradiance
    double pdf_position = 0;   // area measure; 1 for a point or spot light
    double pdf_direction = 0;  // solid angle measure; 1 for a directional light
};

// Absent where the sample carries nothing.
std::optional<LightEmission> sample_emission(const Scene& scene, std::uint32_t light,
                                             Vec2 u_position, LightRandom direction);

struct EmissionPdf {
    double position = 0;   // as LightEmission::pdf_position
    double direction = 0;  // as LightEmission::pdf_direction
};
// Of sample_emission for a point on the light's surface (ignored for other lights) and a direction
// of travel. A direction that sample_emission never gives has density 0; for a directional light
// every direction has the 1 of its own.
EmissionPdf emission_pdf(const Scene& scene, std::uint32_t light, const SurfacePoint& point,
                         Vec3 w);

// The total power of a light into the scene, W.
Rgb light_power(const Scene& scene, std::uint32_t light);

// What light selection knows of every light, by index into scene.lights(). Powers are in π W.
std::vector<LightBounds> light_bounds(const Scene& scene);

}  // namespace misbench
