// A figure's file: what is read, and that everything wrong is said with its place.
#include "experiments/figure/figure_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/base/error.h"
#include "tests/support/temporary_folder.h"

namespace misbench::figure {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kComplete = R"(width: page
font_size: 8
experiment: equal-time
panels:
  - kind: comparison
    title: "Equal time: 100 %"
    scenes:
      - Box
      - {scene: Hall, exposure: -1.5, crops: [[1, 2, 30, 20]]}
    methods: [reference, plain, clever]
    metric: mse
    budget: 16 spp
    titles: {plain: Balance, Hall: The hall}
    crops: {auto: 3, size: [40, 18]}
    maps: {metric: relmse.eps0.01, scale: log, range: [0.01, 10], whole: true}
    full: [plain, clever]
    ratio: gain
  - kind: convergence
    experiment: another
    effort: passes
  - {kind: pareto, effort: wall}
  - {kind: bars, scenes: Box}
  - {kind: sweep, parameter: radius, mark: 0.5}
  - kind: maps
    file: layers/f.exr
    layers: [a, b]
    scale: log
    range: [0.1, 10]
    columns: 2
  - {kind: maps, file: t.exr, show: image, exposure: 2}
)";

class FigureFileTest : public testing::Test {
 protected:
    FigureFile read(const std::string& text) const {
        return read_figure_file(folder_.write("f.yaml", text));
    }
    // The message without the file's folder.
    std::string complaint(const std::string& text) const {
        try {
            read(text);
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), Errc::InvalidArgument);
            const std::string message = e.what();
            EXPECT_EQ(message.find('\n'), std::string::npos) << message;
            const std::string folder = folder_.path().string() + "/";
            return message.starts_with(folder) ? message.substr(folder.size()) : message;
        }
        return "no complaint";
    }
    std::string complaint_about_panel(const std::string& panel) const {
        return complaint("panels:\n  - {" + panel + "}\n");
    }

    TemporaryFolder folder_;
};

TEST_F(FigureFileTest, HasEveryKey) {
    const FigureFile file = read(kComplete);
    EXPECT_EQ(file.width, kPageWidth);
    EXPECT_EQ(file.font_size, 8);
    ASSERT_EQ(file.panels.size(), 7U);

    const Panel& panel = file.panels[0];
    EXPECT_EQ(panel.place.line, 5);
    EXPECT_EQ(panel.title, "Equal time: 100 %");
    EXPECT_EQ(panel.experiment, "equal-time");
    ASSERT_EQ(panel.scenes.size(), 2U);
    EXPECT_EQ(panel.scenes[0].name.value, "Box");
    EXPECT_FALSE(panel.scenes[0].exposure || panel.scenes[0].crops);
    EXPECT_EQ(panel.scenes[1].exposure, -1.5);
    const auto& windows = std::get<std::vector<Placed<Window>>>(*panel.scenes[1].crops);
    ASSERT_EQ(windows.size(), 1U);
    EXPECT_EQ(windows[0].value, (Window{1, 2, 30, 20}));
    EXPECT_EQ(windows[0].place.line, 9);
    ASSERT_EQ(panel.methods.size(), 3U);
    EXPECT_EQ(panel.methods[2].value, "clever");
    EXPECT_EQ(panel.metric.value, "mse");
    EXPECT_EQ(panel.budget.value, "16 spp");
    EXPECT_EQ(panel.title_of("Hall"), "The hall");
    EXPECT_EQ(panel.title_of("Box"), "Box");
    EXPECT_EQ(panel.titles.at("plain").place.line, 13);
    const auto& comparison = std::get<ComparisonPanel>(panel.kind);
    const auto& crops = std::get<AutomaticCrops>(*comparison.crops);
    EXPECT_EQ(crops.count, 3);
    EXPECT_EQ(crops.width, 40);
    EXPECT_EQ(crops.height, 18);
    EXPECT_EQ(crops.place.line, 14);
    EXPECT_EQ(comparison.maps->metric.value, "relmse.eps0.01");
    EXPECT_TRUE(comparison.maps->logarithmic && comparison.maps->whole);
    EXPECT_THAT(*comparison.maps->range, ElementsAre(0.01, 10));
    ASSERT_EQ(comparison.full.size(), 2U);
    EXPECT_EQ(comparison.full[1].value, "clever");
    EXPECT_TRUE(comparison.gain);

    const auto& convergence = std::get<EffortPanel>(file.panels[1].kind);
    EXPECT_EQ(file.panels[1].experiment, "another");
    EXPECT_EQ(convergence.effort, Effort::Passes);
    EXPECT_FALSE(convergence.pareto);
    const auto& pareto = std::get<EffortPanel>(file.panels[2].kind);
    EXPECT_EQ(pareto.effort, Effort::Wall);
    EXPECT_TRUE(pareto.pareto);
    EXPECT_TRUE(std::holds_alternative<BarsPanel>(file.panels[3].kind));
    EXPECT_EQ(file.panels[3].scenes.front().name.value, "Box");
    const auto& sweep = std::get<SweepPanel>(file.panels[4].kind);
    EXPECT_EQ(sweep.parameter.value, "radius");
    EXPECT_EQ(sweep.mark, 0.5);
    const auto& maps = std::get<MapsPanel>(file.panels[5].kind);
    EXPECT_EQ(maps.file, folder_.path() / "layers/f.exr");
    ASSERT_EQ(maps.layers.size(), 2U);
    EXPECT_TRUE(maps.false_colours && maps.logarithmic);
    EXPECT_THAT(*maps.range, ElementsAre(0.1, 10));
    EXPECT_EQ(maps.columns, 2);
    const auto& images = std::get<MapsPanel>(file.panels[6].kind);
    EXPECT_FALSE(images.false_colours);
    EXPECT_EQ(images.exposure, 2);
}

TEST_F(FigureFileTest, NeedsLittle) {
    const FigureFile file = read("panels: [{kind: comparison}]\n");
    EXPECT_EQ(file.width, kColumnWidth);
    const Panel& panel = file.panels.at(0);
    EXPECT_EQ(panel.experiment, "");
    EXPECT_TRUE(panel.scenes.empty() && panel.methods.empty());
    const auto& comparison = std::get<ComparisonPanel>(panel.kind);
    EXPECT_FALSE(comparison.crops || comparison.maps || comparison.gain);
    EXPECT_TRUE(comparison.full.empty());
}

TEST_F(FigureFileTest, IsAsWideAsAPaperNeeds) {
    const auto width = [this](const std::string& text) {
        return read("width: " + text + "\npanels: [{kind: bars}]\n").width;
    };
    EXPECT_EQ(width("column"), 240);
    EXPECT_EQ(width("300pt"), 300);
    EXPECT_DOUBLE_EQ(width("84 mm"), 84 * 72 / 25.4);
    EXPECT_DOUBLE_EQ(width("8.4cm"), 84 * 72 / 25.4);
    EXPECT_DOUBLE_EQ(width("3.5 in"), 252);
    for (const char* wrong : {"wide", "84", "84 em", "mm"}) {
        EXPECT_THAT(complaint("width: " + std::string(wrong) + "\npanels: [{kind: bars}]\n"),
                    AllOf(HasSubstr("f.yaml:1:8: width must be column, page, or a number with pt"),
                          HasSubstr(wrong)));
    }
    for (const char* wrong : {"1 pt", "2001 pt", "nan pt", "inf pt", "-300 pt"}) {
        EXPECT_EQ(complaint("width: " + std::string(wrong) + "\npanels: [{kind: bars}]\n"),
                  "f.yaml:1:8: width must be within 72 and 2000 pt");
    }
    EXPECT_EQ(complaint("font_size: 3\npanels: [{kind: bars}]\n"),
              "f.yaml:1:12: font_size must be within 4 and 24 points");
}

TEST_F(FigureFileTest, NamesWhatIsKnownInPlaceOfAnUnknownWord) {
    EXPECT_THAT(complaint("panel: []\n"), AllOf(HasSubstr("f.yaml:1:1: "), HasSubstr("panels")));
    EXPECT_THAT(complaint("width: page\n"), HasSubstr("panels"));
    EXPECT_THAT(complaint("panels: []\n"), HasSubstr("f.yaml:1:9: panels must be a list"));
    EXPECT_THAT(complaint("panels: [a]\n"), HasSubstr("f.yaml:1:10: "));
    EXPECT_THAT(complaint_about_panel("title: a"), HasSubstr("kind"));
    EXPECT_EQ(complaint_about_panel("kind: pie"),
              "f.yaml:2:12: unknown kind 'pie'; known: comparison convergence pareto bars sweep "
              "maps");
    EXPECT_EQ(complaint_about_panel("kind: pareto, effort: time"),
              "f.yaml:2:28: unknown effort 'time'; known: cpu wall passes");
    EXPECT_EQ(complaint_about_panel("kind: comparison, ratio: speed"),
              "f.yaml:2:31: unknown ratio 'speed'; known: error gain");
    EXPECT_EQ(complaint_about_panel("kind: comparison, maps: {metric: mse, scale: cubic}"),
              "f.yaml:2:51: unknown scale 'cubic'; known: linear log");
    EXPECT_EQ(complaint_about_panel("kind: maps, file: f, show: x"),
              "f.yaml:2:33: unknown show 'x'; known: false-colours image");
}

// A key that would do nothing is an error.
TEST_F(FigureFileTest, EachKindHasItsOwnKeys) {
    for (const auto& [kind, key] :
         {std::pair{"comparison", "effort: cpu"}, std::pair{"convergence", "budget: 16 spp"},
          std::pair{"pareto", "budget: 16 spp"}, std::pair{"bars", "crops: [[0, 0, 1, 1]]"},
          std::pair{"bars", "effort: cpu"}, std::pair{"sweep", "maps: {metric: mse}"},
          std::pair{"maps", "scenes: Box"}, std::pair{"maps", "metric: mse"}}) {
        const std::string name = std::string(key).substr(0, std::string(key).find(':'));
        EXPECT_THAT(
            complaint_about_panel("kind: " + std::string(kind) + ", " + key),
            AllOf(HasSubstr("f.yaml:2:"), HasSubstr("unknown key '" + name + "'; known: kind ")));
    }
    EXPECT_THAT(complaint_about_panel("kind: bars, scenes: [{scene: Box, exposure: 1}]"),
                HasSubstr("f.yaml:2:27: scene must be text"));
    EXPECT_THAT(complaint_about_panel("kind: sweep"), HasSubstr("parameter"));
    EXPECT_THAT(complaint_about_panel("kind: maps"), HasSubstr("file"));
    EXPECT_EQ(complaint_about_panel("kind: maps, file: f, show: image, range: [0, 1]"),
              "f.yaml:2:40: range needs show: false-colours");
    EXPECT_EQ(complaint_about_panel("kind: maps, file: f, exposure: 1"),
              "f.yaml:2:27: exposure needs show: image");
}

TEST_F(FigureFileTest, CropsLieInAnImage) {
    EXPECT_THAT(complaint_about_panel("kind: comparison, crops: []"),
                HasSubstr("f.yaml:2:31: crops must be a list of [x, y, width, height]"));
    EXPECT_THAT(complaint_about_panel("kind: comparison, crops: [[1, 2, 3]]"),
                HasSubstr("f.yaml:2:32: a crop must be a list of four"));
    EXPECT_THAT(complaint_about_panel("kind: comparison, crops: [[-1, 2, 3, 4]]"),
                HasSubstr("f.yaml:2:33: a crop's side must be a decimal integer from 0"));
    EXPECT_THAT(complaint_about_panel("kind: comparison, crops: [[1, 2, 0, 4]]"),
                HasSubstr("f.yaml:2:39: a crop's side must be a decimal integer from 1"));
    EXPECT_THAT(complaint_about_panel("kind: comparison, crops: [[1, 2, 3, 99999]]"),
                HasSubstr("to 16384"));
    std::string nine;
    for (int i = 0; i < 9; ++i) nine += "[0, 0, 1, 1],";
    EXPECT_EQ(complaint_about_panel("kind: comparison, crops: [" + nine + "]"),
              "f.yaml:2:31: crops: at most 8");
    EXPECT_THAT(complaint_about_panel("kind: comparison, crops: {auto: 2}"), HasSubstr("size"));
    EXPECT_THAT(complaint_about_panel("kind: comparison, crops: {auto: 9, size: [1, 1]}"),
                HasSubstr("auto must be a decimal integer from 1 to 8"));
    EXPECT_THAT(complaint_about_panel("kind: comparison, crops: {auto: 1, size: 4}"),
                HasSubstr("size must be a list of two"));
    EXPECT_THAT(complaint_about_panel("kind: comparison, crops: {auto: 1, size: [0, 4]}"),
                HasSubstr("size must be a decimal integer from 1"));
    EXPECT_THAT(complaint_about_panel("kind: comparison, full: [a, b, c]"),
                HasSubstr("full: one method, or two to split it"));
}

TEST_F(FigureFileTest, RangesGrow) {
    EXPECT_THAT(complaint_about_panel("kind: maps, file: f, range: [1]"),
                HasSubstr("range must be a list of two numbers"));
    EXPECT_THAT(complaint_about_panel("kind: maps, file: f, range: [1, 1]"),
                HasSubstr("range: low must be below high"));
    EXPECT_THAT(complaint_about_panel("kind: maps, file: f, scale: log, range: [0, 1]"),
                HasSubstr("range: low must be above 0 on a logarithmic scale"));
    EXPECT_THAT(complaint_about_panel("kind: maps, file: f, columns: 0"),
                HasSubstr("columns must be a decimal integer from 1"));
    EXPECT_THAT(complaint_about_panel("kind: sweep, parameter: a, mark: b"),
                HasSubstr("mark must be a number"));
}

TEST_F(FigureFileTest, TitlesAreOneLineOfUtf8) {
    EXPECT_EQ(complaint_about_panel("kind: bars, title: 'a \xff b'"),
              "f.yaml:2:25: title must be UTF-8");
    EXPECT_EQ(read("panels: [{kind: bars, title: Größe 你好}]\n").panels[0].title, "Größe 你好");
    EXPECT_EQ(complaint_about_panel(R"(kind: bars, title: "a\nb")"),
              "f.yaml:2:25: title must be one line without control characters");
    EXPECT_EQ(complaint_about_panel(R"(kind: bars, titles: {Box: "a\x01"})"),
              "f.yaml:2:32: a title must be one line without control characters");
}

TEST_F(FigureFileTest, MustBeThere) {
    EXPECT_THROW(
        {
            try {
                read_figure_file(folder_.path() / "none.yaml");
            } catch (const Error& e) {
                EXPECT_EQ(e.code(), Errc::NotFound);
                EXPECT_THAT(e.what(), HasSubstr("none.yaml"));
                throw;
            }
        },
        Error);
}

}  // namespace
}  // namespace misbench::figure
