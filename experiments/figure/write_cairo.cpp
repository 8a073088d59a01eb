// PDF and PNG.
#include <cairo-pdf.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiments/figure/pango.h"
#include "experiments/figure/write.h"
#include "renderer/base/error.h"

namespace misbench::figure {
namespace {

void set_colour(cairo_t* cairo, const Colour& colour, double opacity = 1) {
    cairo_set_source_rgba(cairo, colour.red, colour.green, colour.blue, opacity);
}

void draw(cairo_t* cairo, const Typeface&, const Picture& picture) {
    const Raster& raster = picture.raster;
    const Surface surface(
        cairo_image_surface_create(CAIRO_FORMAT_RGB24, raster.width, raster.height));
    cairo_surface_flush(surface.get());
    unsigned char* data = cairo_image_surface_get_data(surface.get());
    const int stride = cairo_image_surface_get_stride(surface.get());
    for (int y = 0; y < raster.height; ++y) {
        const std::uint8_t* from = raster.rgb.data() + 3 * std::ptrdiff_t{y} * raster.width;
        auto* to = reinterpret_cast<std::uint32_t*>(data + std::ptrdiff_t{y} * stride);
        for (int x = 0; x < raster.width; ++x, from += 3) {
            to[x] = std::uint32_t{from[0]} << 16U | std::uint32_t{from[1]} << 8U |
                    std::uint32_t{from[2]};
        }
    }
    cairo_surface_mark_dirty(surface.get());
    cairo_save(cairo);
    cairo_translate(cairo, picture.box.x, picture.box.y);
    cairo_scale(cairo, picture.box.width / raster.width, picture.box.height / raster.height);
    cairo_set_source_surface(cairo, surface.get(), 0, 0);
    cairo_pattern_set_filter(cairo_get_source(cairo), CAIRO_FILTER_NEAREST);
    cairo_rectangle(cairo, 0, 0, raster.width, raster.height);
    cairo_fill(cairo);
    cairo_restore(cairo);
}

void draw(cairo_t* cairo, const Typeface&, const Shape& shape) {
    // Text leaves its end as the current point, from which a line would be drawn.
    cairo_new_path(cairo);
    for (const Point& p : shape.points) cairo_line_to(cairo, p.x, p.y);
    if (shape.closed) cairo_close_path(cairo);
    if (shape.fill) {
        set_colour(cairo, *shape.fill, shape.fill_opacity);
        cairo_fill_preserve(cairo);
    }
    if (shape.stroke) {
        set_colour(cairo, *shape.stroke);
        cairo_set_line_width(cairo, shape.line_width);
        cairo_set_dash(cairo, shape.dashes.data(), static_cast<int>(shape.dashes.size()), 0);
        cairo_stroke_preserve(cairo);
    }
    cairo_new_path(cairo);
}

void draw(cairo_t* cairo, const Typeface& typeface, const Label& label) {
    const Layout layout = lay_out(cairo, typeface, label.text, label.size, label.bold);
    PangoRectangle extents;
    pango_layout_get_extents(layout.get(), nullptr, &extents);
    const double width = static_cast<double>(extents.width) / PANGO_SCALE;
    cairo_save(cairo);
    cairo_translate(cairo, label.at.x, label.at.y);
    if (label.upwards) cairo_rotate(cairo, -std::numbers::pi / 2);
    cairo_move_to(cairo, -width * (static_cast<int>(label.anchor) / 2.0), 0);
    set_colour(cairo, label.colour);
    pango_cairo_show_layout_line(cairo, pango_layout_get_line_readonly(layout.get(), 0));
    cairo_restore(cairo);
}

cairo_status_t append(void* bytes, const unsigned char* data, unsigned int length) {
    static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
    return CAIRO_STATUS_SUCCESS;
}

void require_success(cairo_status_t status) {
    if (status == CAIRO_STATUS_SUCCESS) return;
    throw Error(Errc::Internal, std::string("draw a figure: ") + cairo_status_to_string(status));
}

void draw_all(cairo_surface_t* surface, const Drawing& drawing, const Typeface& typeface,
              double scale) {
    const Context cairo(cairo_create(surface));
    cairo_scale(cairo.get(), scale, scale);
    for (const Item& item : drawing.items) {
        std::visit([&](const auto& i) { draw(cairo.get(), typeface, i); }, item);
    }
    require_success(cairo_status(cairo.get()));
}

}  // namespace

std::string to_pdf(const Drawing& drawing, const Typeface& typeface, const About& about) {
    std::string bytes;
    const Surface surface(
        cairo_pdf_surface_create_for_stream(append, &bytes, drawing.width, drawing.height));
    const auto set = [&surface](cairo_pdf_metadata_t key, const std::string& value) {
        cairo_pdf_surface_set_metadata(surface.get(), key, value.c_str());
    };
    set(CAIRO_PDF_METADATA_TITLE, about.title);
    set(CAIRO_PDF_METADATA_SUBJECT, about.description);
    // The time of drawing, which would be there otherwise, makes every file another one.
    set(CAIRO_PDF_METADATA_CREATE_DATE, "2000-01-01T00:00:00Z");
    draw_all(surface.get(), drawing, typeface, 1);
    cairo_surface_finish(surface.get());
    require_success(cairo_surface_status(surface.get()));
    return bytes;
}

std::string to_png(const Drawing& drawing, const Typeface& typeface) {
    const double scale = kPngDotsPerInch / 72;
    const auto pixels = [scale](double length) {
        return static_cast<int>(std::lround(length * scale));
    };
    constexpr int kMostPixels = 32'767;  // a side, of Cairo's images
    if (std::max(pixels(drawing.width), pixels(drawing.height)) > kMostPixels) {
        throw Error(
            Errc::InvalidArgument,
            fmt::format("draw a figure: {:.0f} x {:.0f} pt is too large for PNG; PDF or SVG "
                        "may be as large",
                        drawing.width, drawing.height));
    }
    const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, pixels(drawing.width),
                                                     pixels(drawing.height)));
    {
        const Context cairo(cairo_create(surface.get()));
        set_colour(cairo.get(), kWhite);
        cairo_paint(cairo.get());
    }
    draw_all(surface.get(), drawing, typeface, scale);
    std::string bytes;
    require_success(cairo_surface_write_to_png_stream(surface.get(), append, &bytes));
    return bytes;
}

}  // namespace misbench::figure
