#include "experiments/figure/typeface.h"

#include <fmt/format.h>

#include <array>

#include "experiments/figure/pango.h"
#include "renderer/base/error.h"

namespace misbench::figure {
namespace {

constexpr std::array kFamilies = {"Linux Biolinum O", "DejaVu Sans"};

// Measures, and draws nothing. Without bounds: Cairo drops glyphs far outside of a surface.
Context measuring_context() {
    const Surface surface(cairo_recording_surface_create(CAIRO_CONTENT_ALPHA, nullptr));
    return Context(cairo_create(surface.get()));
}

bool is_installed(const std::string& name) {
    PangoFontFamily** families = nullptr;
    int n_families = 0;
    pango_font_map_list_families(pango_cairo_font_map_get_default(), &families, &n_families);
    bool found = false;
    for (int i = 0; i < n_families; ++i) found |= pango_font_family_get_name(families[i]) == name;
    g_free(families);
    return found;
}

}  // namespace

Layout lay_out(cairo_t* context, const Typeface& typeface, std::string_view text, double size,
               bool bold) {
    Layout layout(pango_cairo_create_layout(context));
    PangoContext* settings = pango_layout_get_context(layout.get());
    cairo_font_options_t* options = cairo_font_options_create();
    cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
    cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
    pango_cairo_context_set_font_options(settings, options);
    cairo_font_options_destroy(options);
    pango_context_set_round_glyph_positions(settings, FALSE);
    PangoFontDescription* font = pango_font_description_new();
    pango_font_description_set_family(font, typeface.family.c_str());
    pango_font_description_set_weight(font, bold ? PANGO_WEIGHT_BOLD : PANGO_WEIGHT_NORMAL);
    pango_font_description_set_absolute_size(font, size * PANGO_SCALE);
    pango_layout_set_font_description(layout.get(), font);
    pango_font_description_free(font);
    pango_layout_set_text(layout.get(), text.data(), static_cast<int>(text.size()));
    return layout;
}

Typeface choose_typeface() {
    std::string names;
    for (const char* family : kFamilies) {
        if (is_installed(family)) return {family};
        names += fmt::format(" '{}'", family);
    }
    throw Error(Errc::NotFound, "draw a figure: none of its fonts is installed; known:" + names +
                                    " (packages fonts-linuxlibertine, fonts-dejavu-core)");
}

bool is_preferred(const Typeface& typeface) { return typeface.family == kFamilies.front(); }

double text_width(const Typeface& typeface, std::string_view text, double size, bool bold) {
    const Context context = measuring_context();
    const Layout layout = lay_out(context.get(), typeface, text, size, bold);
    PangoRectangle extents;
    pango_layout_get_extents(layout.get(), nullptr, &extents);
    return static_cast<double>(extents.width) / PANGO_SCALE;
}

std::string text_outline(const Typeface& typeface, std::string_view text, double size, bool bold) {
    const Context context = measuring_context();
    const Layout layout = lay_out(context.get(), typeface, text, size, bold);
    cairo_move_to(context.get(), 0, 0);
    pango_cairo_layout_line_path(context.get(), pango_layout_get_line_readonly(layout.get(), 0));
    cairo_path_t* path = cairo_copy_path(context.get());
    std::string data;
    for (int i = 0; i < path->num_data; i += path->data[i].header.length) {
        const cairo_path_data_t* element = &path->data[i];
        constexpr std::string_view kLetters = "MLCZ";  // in the order of cairo_path_data_type_t
        data += kLetters[static_cast<std::size_t>(element->header.type)];
        for (int k = 1; k < element->header.length; ++k) {
            data += fmt::format("{}{:.3f} {:.3f}", k == 1 ? "" : " ", element[k].point.x,
                                element[k].point.y);
        }
    }
    cairo_path_destroy(path);
    return data;
}

}  // namespace misbench::figure
