// Owners of the C objects of Cairo and Pango, and the one way to lay out a line of text.
#pragma once

#include <pango/pangocairo.h>

#include <memory>
#include <string_view>

#include "experiments/figure/typeface.h"

namespace misbench::figure {

struct Release {
    void operator()(cairo_t* c) const { cairo_destroy(c); }
    void operator()(cairo_surface_t* s) const { cairo_surface_destroy(s); }
    void operator()(PangoLayout* l) const { g_object_unref(l); }
};
using Context = std::unique_ptr<cairo_t, Release>;
using Surface = std::unique_ptr<cairo_surface_t, Release>;
using Layout = std::unique_ptr<PangoLayout, Release>;

// Without hinting and whole-pixel advances, so that all formats have the same widths.
Layout lay_out(cairo_t* context, const Typeface& typeface, std::string_view text, double size,
               bool bold);

}  // namespace misbench::figure
