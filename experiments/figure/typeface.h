// The font of a figure, and how wide its text is.
#pragma once

#include <string>
#include <string_view>

namespace misbench::figure {

struct Typeface {
    std::string family;
};

// Linux Biolinum, the sans serif of ACM's formats, where it is installed, else the first of those
// that usually are. Throws NotFound where none is: another font would give other widths.
Typeface choose_typeface();
bool is_preferred(const Typeface& typeface);

double text_width(const Typeface& typeface, std::string_view text, double size, bool bold);

// The outlines of a line of text that starts at the origin, as the data of an SVG path.
std::string text_outline(const Typeface& typeface, std::string_view text, double size, bool bold);

}  // namespace misbench::figure
