#include "renderer/scene/mitsuba/sensor.h"

#include <array>
#include <charconv>
#include <cmath>

#include "renderer/base/names.h"
#include "renderer/scene/mitsuba/transform.h"

namespace misbench::mitsuba {
namespace {

using FovAxis = PerspectiveCamera::FovAxis;

struct NamedAxis {
    const char* name;
    FovAxis axis;
};
constexpr std::array kAxes{NamedAxis{"x", FovAxis::Horizontal}, NamedAxis{"y", FovAxis::Vertical},
                           NamedAxis{"diagonal", FovAxis::Diagonal},
                           NamedAxis{"smaller", FovAxis::Smaller},
                           NamedAxis{"larger", FovAxis::Larger}};

// Of a film of 36 × 24 mm, along its diagonal.
float fov_of_focal_length(const Object& object, const std::string& text) {
    float millimeters = 0;
    const char* end = text.data() + text.size();
    const auto [stop, status] = std::from_chars(text.data(), end, millimeters);
    if (status != std::errc() || !(std::string_view(stop, end) == "mm" || stop == end) ||
        !(millimeters > 0)) {
        object.fail("'focal_length' must be like \"50mm\", found '" + text + "'");
    }
    return 2 * std::atan(std::hypot(36.0F, 24.0F) / (2 * millimeters)) * 180 / kPi;
}

void read_fov(Object& object, PerspectiveCamera& camera) {
    if (!object.has("fov")) {
        if (object.has("fov_axis")) object.fail("'fov_axis' without 'fov'");
        camera.fov_degrees = fov_of_focal_length(object, object.text("focal_length", "50mm"));
        camera.fov_axis = FovAxis::Diagonal;
        return;
    }
    if (object.has("focal_length")) object.fail("has both 'fov' and 'focal_length'");
    camera.fov_degrees = object.number("fov", 0);
    if (!(camera.fov_degrees > 0 && camera.fov_degrees < 180)) {
        object.fail("'fov' must be between 0 and 180 degrees");
    }
    try {
        camera.fov_axis =
            find_named(kAxes, object.text("fov_axis", "x"), "fov_axis", "fov_axis").axis;
    } catch (const ParameterError& e) {
        object.fail(e.what());
    }
}

void read_film(Context& context, Object& film, PerspectiveCamera& camera) {
    const auto whole = [&film](const char* name, std::int64_t fallback, std::int64_t least) {
        const std::int64_t value = film.integer(name, fallback);
        if (value < least || value > 65536)
            film.fail(std::string("'") + name + "' is out of range");
        return value;
    };
    const bool has_size = film.has("width") && film.has("height");
    const bool has_crop = film.has("crop_width") || film.has("crop_height") ||
                          film.has("crop_offset_x") || film.has("crop_offset_y");
    if (has_crop && !has_size) film.fail("a crop needs 'width' and 'height'");
    const std::int64_t width = whole("width", 768, 1);
    const std::int64_t height = whole("height", 576, 1);
    const std::int64_t crop_width = whole("crop_width", width, 1);
    const std::int64_t crop_height = whole("crop_height", height, 1);
    const std::int64_t x = whole("crop_offset_x", 0, 0);
    const std::int64_t y = whole("crop_offset_y", 0, 0);
    if (x + crop_width > width || y + crop_height > height) {
        film.fail("the crop reaches beyond the film");
    }
    const auto fraction = [](std::int64_t part, std::int64_t all) {
        return static_cast<float>(static_cast<double>(part) / static_cast<double>(all));
    };
    camera.window = {fraction(x, width), fraction(y, height), fraction(x + crop_width, width),
                     fraction(y + crop_height, height)};
    if (has_size)
        context.scene.film = {static_cast<int>(crop_width), static_cast<int>(crop_height)};
    // How Mitsuba stores and tone-maps its images.
    film.ignore({"gamma", "banner", "pixel_format", "component_format", "file_format", "attach_log",
                 "compensate", "sample_border", "high_quality_edges", "tonemap_method", "exposure",
                 "key", "burn"});
    for (const Object* filter : film.children_of("rfilter")) {
        if (filter->type != "box") {
            context.note("reconstruction filter '" + filter->type + "' ignored: pixels are boxes");
        }
    }
    film.expect_all_read();
}

}  // namespace

void read_sensor(Context& context, Object& object) {
    if (object.type != "perspective" && object.type != "thinlens") {
        object.refuse_type("perspective thinlens");
    }
    PerspectiveCamera camera;
    const Transform to_world = object.transform("to_world");
    if (!is_orthonormal(to_world)) object.fail("'to_world' scales or shears the camera");
    // Mitsuba's camera looks along +z with x to the left, ours along -z with x to the right.
    camera.to_world = compose(to_world, scaling({-1, 1, -1}));
    read_fov(object, camera);
    if (object.has("near_clip") || object.has("far_clip")) {
        context.note("near and far clip of the camera ignored");
    }
    object.positive("near_clip", 0.01F);
    const float far_clip = object.positive("far_clip", 1e4F);
    for (const char* offset : {"principal_point_offset_x", "principal_point_offset_y"}) {
        if (object.number(offset, 0) != 0) {
            object.fail(std::string("'") + offset + "' other than 0 is not supported");
        }
    }
    if (object.type == "thinlens") {
        if (!object.has("aperture_radius")) object.fail("missing 'aperture_radius'");
        camera.lens_radius = object.number("aperture_radius", 0);
        if (!(camera.lens_radius >= 0)) object.fail("'aperture_radius' must not be negative");
        camera.focus_distance = object.positive("focus_distance", far_clip);
    } else {
        object.ignore({"focus_distance"});  // of a camera that has everything in focus
    }
    object.ignore({"shutter_open", "shutter_close"});  // nothing moves
    object.children_of("sampler");
    for (Object* film : object.children_of("film")) read_film(context, *film, camera);
    object.expect_all_read();
    context.scene.camera = camera;
}

}  // namespace misbench::mitsuba
