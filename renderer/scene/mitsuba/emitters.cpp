#include "renderer/scene/mitsuba/emitters.h"

#include <memory>

#include "renderer/image/image.h"
#include "renderer/scene/mitsuba/spectrum.h"
#include "renderer/scene/mitsuba/transform.h"

namespace misbench::mitsuba {
namespace {

float radians(float degrees) { return degrees * kPi / 180; }

// Version 0.6 has its emitters shine white if nothing is said, version 3 too.
Rgb read_power(Context& context, Object& object, const std::string& name) {
    return read_color(context, object, name, ColorRole::Emission, kWhite);
}

Vec3 axis_of(const Object& object, const Transform& to_world) {
    const Vec3 z = column(to_world, 2);
    if (!(length(z) > 0)) object.fail("'to_world' leaves no direction");
    return normalized(z);
}

void read_point(Context& context, Object& object) {
    if (object.has("position") && object.has("to_world")) {
        object.fail("has both 'position' and 'to_world'");
    }
    const Vec3 origin = object.transform("to_world").translation();
    context.scene.point_lights.push_back(
        {object.vec3("position", origin), read_power(context, object, "intensity")});
}

void read_spot(Context& context, Object& object) {
    const Transform to_world = object.transform("to_world");
    const float cutoff = object.positive("cutoff_angle", 20);
    const float beam = object.number("beam_width", cutoff * 0.75F);
    if (!(cutoff < 180 && beam >= 0 && beam <= cutoff)) {
        object.fail("expected 0 <= 'beam_width' <= 'cutoff_angle' < 180");
    }
    context.scene.spot_lights.push_back({.position = to_world.translation(),
                                         .direction = axis_of(object, to_world),
                                         .intensity = read_power(context, object, "intensity"),
                                         .cutoff_angle = radians(cutoff),
                                         .beam_width = radians(beam)});
}

void read_directional(Context& context, Object& object) {
    if (object.has("direction") && object.has("to_world")) {
        object.fail("has both 'direction' and 'to_world'");
    }
    const Vec3 direction = object.vec3("direction", axis_of(object, object.transform("to_world")));
    if (!(length(direction) > 0)) object.fail("'direction' is 0");
    context.scene.directional_lights.push_back(
        {normalized(direction), read_power(context, object, "irradiance")});
}

EnvironmentDescription read_constant(Context& context, Object& object) {
    const Rgb radiance = read_power(context, object, "radiance");
    auto image = std::make_shared<Image>(1, 1);
    image->rgb = {radiance.r, radiance.g, radiance.b};
    return {.radiance = std::move(image)};
}

EnvironmentDescription read_envmap(Context& context, Object& object) {
    const Transform to_world = object.transform("to_world");
    if (!is_orthonormal(to_world)) object.fail("'to_world' scales or shears");
    Image image = read_radiance_map(context.folder / object.text("filename"));
    const float scale = object.number("scale", 1);
    if (!(scale >= 0)) object.fail("'scale' must not be negative");
    for (float& channel : image.rgb) channel *= scale;
    object.ignore({"cache"});
    // Mitsuba's columns begin at -z and go by way of +x; ours begin at +x and go by way of +z.
    const Transform map_to_mitsuba = from_columns({0, 0, -1}, {0, 1, 0}, {1, 0, 0}, {});
    Transform map_to_world = compose(to_world, map_to_mitsuba);
    for (auto& row : map_to_world.rows) row[3] = 0;
    return {.radiance = std::make_shared<const Image>(std::move(image)),
            .filter = EnvironmentDescription::Filter::Bilinear,
            .to_world = map_to_world};
}

}  // namespace

void read_emitter(Context& context, Object& object) {
    const bool is_environment = object.type == "constant" || object.type == "envmap";
    if (is_environment && context.scene.environment) {
        object.fail("the scene has more than one environment");
    }
    if (object.type == "point") {
        read_point(context, object);
    } else if (object.type == "spot") {
        read_spot(context, object);
    } else if (object.type == "directional") {
        read_directional(context, object);
    } else if (object.type == "constant") {
        context.scene.environment = read_constant(context, object);
    } else if (object.type == "envmap") {
        context.scene.environment = read_envmap(context, object);
    } else if (object.type == "area") {
        object.fail("belongs inside a shape");
    } else {
        object.refuse_type("area constant directional envmap point spot");
    }
    object.ignore({"sampling_weight"});  // how often Mitsuba chooses it
    object.expect_all_read();
}

}  // namespace misbench::mitsuba
