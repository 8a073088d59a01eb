// TikZ, and the choice of a format.
#include <fmt/format.h>

#include <algorithm>

#include "experiments/figure/write.h"
#include "experiments/report/table_formats.h"
#include "renderer/base/error.h"
#include "renderer/base/files.h"
#include "renderer/image/image.h"

namespace misbench::figure {
namespace {

std::string definition(const Colour& colour) {
    return fmt::format(
        "{{rgb,255:red,{};green,{};blue,{}}}", static_cast<int>(255 * colour.red + 0.5),
        static_cast<int>(255 * colour.green + 0.5), static_cast<int>(255 * colour.blue + 0.5));
}

// TeX's big points are the others' points, and its y goes upwards.
class TexWriter {
 public:
    TexWriter(const Typeface& typeface, std::string stem)
        : typeface_(typeface), stem_(std::move(stem)) {}

    void operator()(const Picture& picture) {
        const Raster& raster = picture.raster;
        files_.pictures.push_back(encode_png(raster.width, raster.height, raster.rgb));
        files_.tex += fmt::format(
            "\\node[inner sep=0, anchor=north west] at ({:.3f}bp,{:.3f}bp) "
            "{{\\includegraphics[width={:.3f}bp, height={:.3f}bp]{{{}-{}.png}}}};\n",
            picture.box.x, -picture.box.y, picture.box.width, picture.box.height, stem_,
            files_.pictures.size());
    }

    void operator()(const Shape& shape) {
        std::string options;
        if (shape.fill) {
            options += fmt::format("fill={}, fill opacity={}, ", definition(*shape.fill),
                                   shape.fill_opacity);
        }
        if (shape.stroke) {
            options += fmt::format("draw={}, line width={}bp, ", definition(*shape.stroke),
                                   shape.line_width);
            if (!shape.dashes.empty()) {
                options += "dash pattern=";
                for (std::size_t i = 0; i < shape.dashes.size(); ++i) {
                    options += fmt::format("{} {}bp ", i % 2 == 0 ? "on" : "off", shape.dashes[i]);
                }
            }
        }
        std::string points;
        for (const Point& p : shape.points) {
            points += fmt::format("{}({:.3f}bp,{:.3f}bp)", points.empty() ? "" : " -- ", p.x, -p.y);
        }
        files_.tex +=
            fmt::format("\\path[{}] {}{};\n", options, points, shape.closed ? " -- cycle" : "");
    }

    void operator()(const Label& label) {
        constexpr const char* kAnchors[] = {"base west", "base", "base east"};
        files_.tex += fmt::format(
            "\\node[inner sep=0, anchor={}, text={}{}, font=\\fontsize{{{}bp}}{{{}bp}}"
            "\\selectfont{}] at ({:.3f}bp,{:.3f}bp) {{\\figurefit{{{:.3f}bp}}{{{}}}}};\n",
            kAnchors[static_cast<int>(label.anchor)], definition(label.colour),
            label.upwards ? ", rotate=90" : "", label.size, 1.2 * label.size,
            label.bold ? "\\bfseries" : "", label.at.x, -label.at.y,
            text_width(typeface_, label.text, label.size, label.bold), escape_latex(label.text));
    }

    TexFiles& files() { return files_; }

 private:
    const Typeface& typeface_;
    std::string stem_;
    TexFiles files_;
};

}  // namespace

TexFiles to_tex(const Drawing& drawing, const Typeface& typeface, const std::string& stem,
                const About& about) {
    TexWriter writer(typeface, stem);
    writer.files().tex = fmt::format(
        "% {}\n% Needs \\usepackage{{tikz}}; \\input where the figure shall be.\n"
        "\\begin{{tikzpicture}}\n"
        "\\def\\figurefit#1#2{{\\setbox0\\hbox{{#2}}\\ifdim\\wd0>#1\\relax\\resizebox{{#1}}{{!}}"
        "{{\\box0}}\\else\\box0\\fi}}\n\\useasboundingbox (0,0) rectangle ({:.3f}bp,{:.3f}bp);\n",
        about.title, drawing.width, -drawing.height);
    for (const Item& item : drawing.items) std::visit(writer, item);
    writer.files().tex += "\\end{tikzpicture}%\n";
    return writer.files();
}

void require_format(const std::filesystem::path& path) {
    const std::string extension = path.extension();
    if (std::ranges::find(kFormats, extension) == kFormats.end()) {
        throw Error(Errc::InvalidArgument, fmt::format("write '{}': unknown extension; known: {}",
                                                       path.string(), fmt::join(kFormats, " ")));
    }
    constexpr std::string_view kInNames =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_.";
    if (extension == ".tex" &&
        path.stem().string().find_first_not_of(kInNames) != std::string::npos) {
        throw Error(Errc::InvalidArgument,
                    fmt::format("write '{}': for TeX a name must be of letters, digits, '-', '_' "
                                "and '.'",
                                path.string()));
    }
}

void write_figure(const std::filesystem::path& path, const Drawing& drawing,
                  const Typeface& typeface, const About& about) {
    const std::string extension = path.extension();
    if (extension == ".pdf") write_file_durably(path, to_pdf(drawing, typeface, about));
    if (extension == ".svg") write_file_durably(path, to_svg(drawing, typeface, about));
    if (extension == ".png") write_file_durably(path, to_png(drawing, typeface));
    if (extension == ".html") write_file_durably(path, to_html(drawing, typeface, about));
    if (extension == ".tex") {
        const std::string stem = path.stem();
        const TexFiles files = to_tex(drawing, typeface, stem, about);
        for (std::size_t i = 0; i < files.pictures.size(); ++i) {
            write_file_durably(path.parent_path() / fmt::format("{}-{}.png", stem, i + 1),
                               files.pictures[i]);
        }
        write_file_durably(path, files.tex);
    }
}

}  // namespace misbench::figure
