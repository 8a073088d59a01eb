// SVG, and HTML around it.
#include <fmt/format.h>

#include "experiments/figure/write.h"
#include "experiments/report/table_formats.h"
#include "renderer/base/base64.h"
#include "renderer/image/image.h"

namespace misbench::figure {
namespace {

std::string hex(const Colour& colour) {
    return fmt::format("#{:02x}{:02x}{:02x}", static_cast<int>(255 * colour.red + 0.5),
                       static_cast<int>(255 * colour.green + 0.5),
                       static_cast<int>(255 * colour.blue + 0.5));
}

std::string to_element(const Typeface&, const Picture& picture) {
    const Raster& raster = picture.raster;
    return fmt::format(
        "<image x=\"{:.3f}\" y=\"{:.3f}\" width=\"{:.3f}\" height=\"{:.3f}\" "
        "preserveAspectRatio=\"none\" image-rendering=\"pixelated\" "
        "href=\"data:image/png;base64,{}\"><title>{}</title></image>\n",
        picture.box.x, picture.box.y, picture.box.width, picture.box.height,
        base64(encode_png(raster.width, raster.height, raster.rgb)),
        escape_html(picture.description));
}

std::string to_element(const Typeface&, const Shape& shape) {
    std::string points;
    for (const Point& p : shape.points) points += fmt::format("{:.3f},{:.3f} ", p.x, p.y);
    if (!points.empty()) points.pop_back();
    std::string svg =
        fmt::format("<{} points=\"{}\" fill=\"{}\"", shape.closed ? "polygon" : "polyline", points,
                    shape.fill ? hex(*shape.fill) : "none");
    if (shape.fill_opacity != 1) svg += fmt::format(" fill-opacity=\"{}\"", shape.fill_opacity);
    if (shape.stroke) {
        svg +=
            fmt::format(" stroke=\"{}\" stroke-width=\"{}\"", hex(*shape.stroke), shape.line_width);
        if (!shape.dashes.empty()) {
            svg += fmt::format(" stroke-dasharray=\"{}\"", fmt::join(shape.dashes, " "));
        }
    }
    return svg + "/>\n";
}

std::string to_element(const Typeface& typeface, const Label& label) {
    const double width = text_width(typeface, label.text, label.size, label.bold);
    return fmt::format(
        "<path transform=\"translate({:.3f} {:.3f}){} translate({:.3f} 0)\" fill=\"{}\" "
        "aria-label=\"{}\" d=\"{}\"/>\n",
        label.at.x, label.at.y, label.upwards ? " rotate(-90)" : "",
        -width * (static_cast<int>(label.anchor) / 2.0), hex(label.colour), escape_html(label.text),
        text_outline(typeface, label.text, label.size, label.bold));
}

}  // namespace

std::string to_svg(const Drawing& drawing, const Typeface& typeface, const About& about) {
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.3f}pt\" height=\"{1:.3f}pt\" "
        "viewBox=\"0 0 {0:.3f} {1:.3f}\" role=\"img\">\n<title>{2}</title>\n<desc>{3}</desc>\n",
        drawing.width, drawing.height, escape_html(about.title), escape_html(about.description));
    for (const Item& item : drawing.items) {
        svg += std::visit([&](const auto& i) { return to_element(typeface, i); }, item);
    }
    return svg + "</svg>\n";
}

std::string to_html(const Drawing& drawing, const Typeface& typeface, const About& about) {
    return fmt::format(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width\">\n<title>{}</title>\n"
        "<style>body {{ margin: 1rem auto; max-width: 75rem; }} "
        "svg {{ width: 100%; height: auto; }}</style>\n</head>\n<body>\n{}</body>\n</html>\n",
        escape_html(about.title), to_svg(drawing, typeface, about));
}

}  // namespace misbench::figure
