// misbench figure as a process: every kind in every format, of a store with real runs.
#include <gmock/gmock.h>

#include <png.h>

#include <algorithm>
#include <pugixml.hpp>

#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr const char* kExperiment = R"(name: tiny
scenes: [CornellBox, Box/LightTop]
image: {width: 32, height: 24}
methods:
  nee: {method: path, max_depth: 3, bsdf: false}
  mis: {method: path, max_depth: 3}
  deep: {method: path, max_depth: 4}
seeds: 3
budgets: [{samples: 8}]
snapshots: {first: 1, factor: 2}
reference: {method: mis, samples: 32}
metrics: [relmse.eps0.01, mse]
)";

const std::map<std::string, std::string> kPanels = {
    {"comparison",
     "{kind: comparison, crops: {auto: 2, size: [8, 6]}, maps: {metric: mse, scale: log}, "
     "full: [nee, mis], titles: {mis: \"A & B < C_D 100 %\"}}"},
    {"convergence", "{kind: convergence, effort: passes}"},
    {"pareto", "{kind: pareto, effort: cpu}"},
    {"bars", "{kind: bars, metric: mse}"},
    {"sweep", "{kind: sweep, parameter: max_depth, methods: [mis, deep], mark: 3}"},
    {"maps", "{kind: maps, file: layers.exr, scale: log}"},
};
const std::vector<std::string> kExtensions = {"pdf", "svg", "png", "tex", "html"};

struct Png {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> rgb;
};

Png read_png(const std::string& file) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    EXPECT_TRUE(png_image_begin_read_from_file(&image, file.c_str())) << file << image.message;
    image.format = PNG_FORMAT_RGB;
    Png png{static_cast<int>(image.width), static_cast<int>(image.height),
            std::vector<std::uint8_t>(PNG_IMAGE_SIZE(image))};
    EXPECT_TRUE(png_image_finish_read(&image, nullptr, png.rgb.data(), 0, nullptr))
        << file << image.message;
    return png;
}

class FigureCliTest : public testing::Test {
 protected:
    static void SetUpTestSuite() {
        folder_ = std::make_unique<TemporaryFolder>();
        folder_->write("tiny.yaml", kExperiment);
        ASSERT_EQ(run({}).exit_code, 0);
        const Outcome render =
            misbench({"render", "CornellBox", "--method", "bdpt", "--spp", "1", "--size", "16x12",
                      "-o", file("image.exr"), "--techniques", file("layers.exr")});
        ASSERT_EQ(render.exit_code, 0) << render.err;
        for (const auto& [kind, panel] : kPanels) {
            folder_->write(kind + ".yaml", "experiment: tiny\npanels: [" + panel + "]\n");
        }
    }
    static void TearDownTestSuite() { folder_.reset(); }

    static std::string file(const std::string& name) { return (folder_->path() / name).string(); }
    static Outcome misbench(std::vector<std::string> arguments,
                            const ProcessOptions& options = {}) {
        arguments.insert(arguments.begin(), MISBENCH_PROGRAM);
        return Process(arguments, folder_->path(), options).wait();
    }
    static Outcome run(const std::vector<std::string>& more) {
        std::vector<std::string> arguments{"run", file("tiny.yaml"), "--store", file("store")};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return misbench(arguments);
    }
    static Outcome figure(const std::string& yaml, const std::string& output,
                          const ProcessOptions& options = {}) {
        return misbench({"figure", file(yaml), "--store", file("store"), "-o", file(output)},
                        options);
    }
    static std::string made(const std::string& kind, const std::string& output) {
        const Outcome outcome = figure(kind + ".yaml", output);
        EXPECT_EQ(outcome.exit_code, 0) << kind << ": " << outcome.err;
        EXPECT_EQ(outcome.out, "");
        EXPECT_THAT(outcome.err, HasSubstr("wrote " + file(output)));
        return slurp(file(output));
    }
    static void expect_error(const Outcome& outcome, int exit_code, const std::string& message) {
        EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
        EXPECT_THAT(outcome.err, AllOf(StartsWith("misbench: error: "), HasSubstr(message)));
        EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
    }
    static std::vector<std::string> files_in(const std::string& folder) {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(file(folder))) {
            names.push_back(entry.path().filename());
        }
        return names;
    }

    inline static std::unique_ptr<TemporaryFolder> folder_;
};

TEST_F(FigureCliTest, EveryKindIsAWholePdfWithItsFonts) {
    for (const auto& [kind, panel] : kPanels) {
        const std::string pdf = made(kind, kind + ".pdf");
        EXPECT_THAT(pdf, StartsWith("%PDF-")) << kind;
        EXPECT_THAT(pdf.substr(pdf.size() - 8), HasSubstr("%%EOF")) << kind;
        EXPECT_THAT(pdf, HasSubstr("/FontFile")) << kind;
        EXPECT_THAT(pdf, HasSubstr("/CreationDate (20000101"))
            << kind << " is the same at any time";
        EXPECT_THAT(pdf, HasSubstr("/MediaBox [ 0 0 240 ")) << kind;
    }
}

TEST_F(FigureCliTest, EveryKindIsAnImageThatIsNotBlank) {
    for (const auto& [kind, panel] : kPanels) {
        made(kind, kind + ".png");
        const Png image = read_png(file(kind + ".png"));
        EXPECT_EQ(image.width, 1000) << kind;  // 240 pt at 300 dots an inch
        EXPECT_GT(image.height, 100) << kind;
        const auto n_white = std::ranges::count(image.rgb, 255);
        EXPECT_GT(n_white, 0) << kind;
        EXPECT_LT(n_white, std::ssize(image.rgb)) << kind;
    }
}

TEST_F(FigureCliTest, EveryKindIsWellFormedSvgInHtmlToo) {
    for (const auto& [kind, panel] : kPanels) {
        const std::string text = made(kind, kind + ".svg");
        pugi::xml_document svg;
        const auto parsed = svg.load_string(text.c_str());
        ASSERT_TRUE(parsed) << kind << ": " << parsed.description();
        const pugi::xml_node root = svg.child("svg");
        EXPECT_STREQ(root.child_value("desc"), kind == "maps" ? "" : "Experiments: tiny");
        EXPECT_TRUE(root.child("path")) << kind << " has text";
        const std::string html = made(kind, kind + ".html");
        EXPECT_THAT(html, AllOf(StartsWith("<!doctype html>"), HasSubstr("</svg>"),
                                Not(HasSubstr("http://www.w3.org/1999")), Not(HasSubstr("src="))));
        // The page's <meta> elements have no end, but the drawing is the same.
        EXPECT_THAT(html, HasSubstr(text.substr(text.find("</desc>"))));
    }
    EXPECT_THAT(slurp(file("comparison.svg")),
                HasSubstr("aria-label=\"A &amp; B &lt; C_D 100 %\""));
}

TEST_F(FigureCliTest, TexNamesPicturesThatAreThere) {
    for (const auto& [kind, panel] : kPanels) {
        const std::string tex = made(kind, kind + ".tex");
        EXPECT_THAT(tex, AllOf(HasSubstr("\\begin{tikzpicture}"), HasSubstr("\\end{tikzpicture}")));
        int n_pictures = 0;
        for (std::size_t at = 0; (at = tex.find("]{" + kind + "-", at)) != std::string::npos;
             ++at) {
            const std::string name = tex.substr(at + 2, tex.find('}', at) - at - 2);
            EXPECT_GT(read_png(file(name)).width, 0) << name;
            ++n_pictures;
        }
        EXPECT_EQ(n_pictures > 0, kind == "comparison" || kind == "maps") << kind;
        EXPECT_EQ(std::ranges::count(tex, '{'), std::ranges::count(tex, '}')) << kind;
    }
    EXPECT_THAT(slurp(file("comparison.tex")), HasSubstr(R"(A \& B $<$ C\_D 100 \%)"));
}

TEST_F(FigureCliTest, TheSameStoreGivesTheSameBytes) {
    for (const auto& [kind, panel] : kPanels) {
        for (const std::string& extension : kExtensions) {
            const std::string name = kind + "." + extension;
            const std::string first = made(kind, name);
            EXPECT_EQ(made(kind, name), first) << name;
        }
    }
}

TEST_F(FigureCliTest, AFigureFollowsItsStore) {
    fs::copy(file("store"), file("before"), fs::copy_options::recursive);
    std::map<std::string, std::string> before;
    for (const auto& [kind, panel] : kPanels) before[kind] = made(kind, "again.svg");
    const Outcome more = run({"--set", "seeds=4"});
    ASSERT_EQ(more.exit_code, 0) << more.err;
    for (const auto& [kind, panel] : kPanels) {
        const std::string after = made(kind, "again.svg");
        EXPECT_EQ(after == before[kind], kind == "maps") << kind;  // which shows a file
    }
    fs::remove_all(file("store"));
    fs::rename(file("before"), file("store"));
}

TEST_F(FigureCliTest, AnErrorLeavesTheOldFileOrNone) {
    folder_->write("wrong.yaml", "panels:\n  - {kind: bars}\n  - {kind: bars, scenes: [Hall]}\n");
    fs::create_directory(file("out"));
    folder_->write("out/old.pdf", "old");
    for (const std::string& extension : kExtensions) {
        expect_error(figure("wrong.yaml", "out/new." + extension), 2,
                     "wrong.yaml:3:27: unknown scene 'Hall'; known: CornellBox Box/LightTop");
    }
    expect_error(figure("wrong.yaml", "out/old.pdf"), 2, "unknown scene");
    EXPECT_THAT(files_in("out"), testing::ElementsAre("old.pdf"));
    EXPECT_EQ(slurp(file("out/old.pdf")), "old");
    expect_error(figure("bars.yaml", "bars.jpg"), 2, "known: .pdf .svg .png .tex .html");
    expect_error(figure("none.yaml", "bars.pdf"), 2, "none.yaml");
    expect_error(figure("bars.yaml", "nowhere/bars.pdf"), 3, "nowhere/bars.pdf");
    folder_->write("layers.yaml", "panels: [{kind: maps, file: none.exr}]\n");
    expect_error(figure("layers.yaml", "out/new.pdf"), 2, "none.exr");
    folder_->write("layer.yaml", "panels: [{kind: maps, file: layers.exr, layers: [wrong]}]\n");
    expect_error(figure("layer.yaml", "out/new.pdf"), 2, "has no layer 'wrong'; known: ");
    expect_error(misbench({"figure", file("bars.yaml"), "--store", file("store"), "--experiment",
                           "huge", "-o", file("out/new.pdf")}),
                 2, "tiny");
    EXPECT_THAT(files_in("out"), testing::ElementsAre("old.pdf"));
}

// Fontconfig is told of one folder of fonts only.
TEST_F(FigureCliTest, AnotherFontIsSaidAndNoneIsAnError) {
    const auto only = [](const std::string& fonts) {
        folder_->write("fonts.conf", "<?xml version=\"1.0\"?><fontconfig><dir>" + fonts +
                                         "</dir><cachedir>" + file("cache") +
                                         "</cachedir></fontconfig>");
        return ProcessOptions{.environment = {{"FONTCONFIG_FILE", file("fonts.conf")}}};
    };
    fs::create_directory(file("no-fonts"));
    expect_error(figure("bars.yaml", "unfonted.pdf", only(file("no-fonts"))), 2,
                 "none of its fonts is installed; known: 'Linux Biolinum O' 'DejaVu Sans'");
    EXPECT_FALSE(fs::exists(file("unfonted.pdf")));
    const fs::path dejavu = "/usr/share/fonts/truetype/dejavu";
    if (!fs::exists(dejavu)) GTEST_SKIP() << "fonts-dejavu-core is not installed";
    const Outcome other = figure("bars.yaml", "dejavu.pdf", only(dejavu));
    EXPECT_EQ(other.exit_code, 0) << other.err;
    EXPECT_THAT(other.err, HasSubstr("text is in DejaVu Sans"));
    EXPECT_THAT(slurp(file("dejavu.pdf")), HasSubstr("DejaVuSans"));
}

}  // namespace
}  // namespace misbench
