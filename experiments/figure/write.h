// A drawing as a file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/figure/drawing.h"
#include "experiments/figure/typeface.h"

namespace misbench::figure {

inline constexpr double kPngDotsPerInch = 300;

// What a figure is, for the metadata of a file and for readers who cannot see it.
struct About {
    std::string title;
    std::string description;
};

// The same drawing gives the same bytes. The fonts are embedded in PDF; in SVG text is outlines.
std::string to_pdf(const Drawing& drawing, const Typeface& typeface, const About& about);
std::string to_png(const Drawing& drawing, const Typeface& typeface);
std::string to_svg(const Drawing& drawing, const Typeface& typeface, const About& about);
std::string to_html(const Drawing& drawing, const Typeface& typeface, const About& about);

struct TexFiles {
    // A tikzpicture, whose text takes the paper's font, but no more room than it has in `typeface`.
    std::string tex;
    std::vector<std::string> pictures;  // PNG, named STEM-1.png and so on
};
TexFiles to_tex(const Drawing& drawing, const Typeface& typeface, const std::string& stem,
                const About& about);

inline const std::vector<std::string> kFormats = {".pdf", ".svg", ".png", ".tex", ".html"};
// Throws InvalidArgument where the extension is none of kFormats, or TeX could not read the name.
void require_format(const std::filesystem::path& path);
// By the extension; a .tex file gets its pictures beside it. REQUIRES: require_format() agrees.
void write_figure(const std::filesystem::path& path, const Drawing& drawing,
                  const Typeface& typeface, const About& about);

}  // namespace misbench::figure
