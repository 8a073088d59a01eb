// What figures say of a store, and what becomes of them in a file.
#include "experiments/figure/figure.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <pugixml.hpp>
#include <random>
#include <sstream>

#include "experiments/figure/clear_best.h"
#include "experiments/figure/colour_map.h"
#include "experiments/figure/write.h"
#include "tests/support/drawings.h"
#include "tests/support/store_fixture.h"

namespace misbench::figure {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

// --- bold ----------------------------------------------------------------------------------------

using Rows = std::vector<std::vector<ComparedCell>>;

ComparedCell measured_cell(std::vector<double> values) {
    ComparedCell cell;
    for (std::size_t i = 0; i < values.size(); ++i) {
        cell.seeds.push_back(static_cast<std::int64_t>(i) + 1);
    }
    cell.mean = estimate_mean(values);
    cell.values = std::move(values);
    return cell;
}

TEST(Bold, IsTheBestThatDiffersFromEachOther) {
    const ComparedCell good = measured_cell({1.0, 1.1, 0.9, 1.05, 0.95});
    const ComparedCell as_good = measured_cell({1.02, 1.07, 0.93, 1.0, 1.0});
    const ComparedCell bad = measured_cell({2.0, 2.3, 1.9, 2.2, 2.1});
    const auto best = [](const std::vector<ComparedCell>& row, Direction better) {
        return clear_bests(Rows{row}, better).at(0);
    };
    EXPECT_EQ(best({bad, good}, Direction::Less), 1U);
    EXPECT_EQ(best({bad, good}, Direction::More), 0U);
    EXPECT_EQ(best({bad, good}, Direction::None), std::nullopt);
    EXPECT_EQ(best({as_good, bad, good}, Direction::Less), std::nullopt);
    EXPECT_EQ(best({ComparedCell{}, good, bad}, Direction::Less), 1U);
    EXPECT_EQ(best({ComparedCell{}, good}, Direction::Less), std::nullopt);
    EXPECT_EQ(best({}, Direction::Less), std::nullopt);
    // With two seeds there is no interval, whatever they say.
    EXPECT_EQ(best({measured_cell({1, 1.1}), measured_cell({9, 9.2})}, Direction::Less),
              std::nullopt);
    EXPECT_EQ(best({good, good}, Direction::Less), std::nullopt);
}

// A row that would be bold alone is not among many that show nothing.
TEST(Bold, IsAdjustedForTheRowsOfTheFigure) {
    const std::vector<ComparedCell> barely = {measured_cell({1.0, 1.1, 0.9, 1.05, 0.95}),
                                              measured_cell({1.2, 1.15, 1.1, 1.12, 1.2})};
    const double p = p_value(*log_ratio(barely[0], barely[1]));
    ASSERT_GT(p, 0.05 / 20);
    ASSERT_LT(p, 0.05);
    EXPECT_EQ(clear_bests(Rows{barely}, Direction::Less).at(0), 0U);
    const std::vector<ComparedCell> nothing = {measured_cell({1.0, 1.1, 0.9, 1.05, 0.95}),
                                               measured_cell({1.02, 1.07, 0.93, 1.0, 1.0})};
    Rows rows(19, nothing);
    rows.push_back(barely);
    EXPECT_THAT(clear_bests(rows, Direction::Less), Each(std::nullopt));
}

// Of five equal methods one is bold in at most 5 % of figures of one row. 2000 rows, fixed seed:
// with that share, more than 130 have a probability below 1 %.
TEST(Bold, IsRareAmongEqualMethods) {
    for (const int n_methods : {2, 5}) {
        std::mt19937 random(7);
        std::lognormal_distribution<double> error(0, 0.3);
        int n_bold = 0;
        for (int trial = 0; trial < 2000; ++trial) {
            std::vector<ComparedCell> row;
            for (int m = 0; m < n_methods; ++m) {
                std::vector<double> values(6);
                for (double& value : values) value = error(random);
                row.push_back(measured_cell(values));
            }
            n_bold += clear_bests(Rows{row}, Direction::Less).at(0) ? 1 : 0;
        }
        EXPECT_LE(n_bold, 130) << n_methods;
    }
}

// --- files ---------------------------------------------------------------------------------------

constexpr const char* kAwkward = "a & b < c_d % #1 {x} \"q\" \\ ~ ^ × – ü";

Drawing awkward_drawing() {
    Drawing drawing{.width = 200, .height = 40, .items = {}};
    drawing.items.push_back(Picture{{0, 0, 20, 20}, plain_raster(2, 2), kAwkward});
    drawing.items.push_back(Label{.at = {2, 30}, .text = kAwkward});
    drawing.items.push_back(line({0, 0}, {10, 10}, kBlack, 1));
    return drawing;
}

TEST(Files, SvgAndHtmlKeepAwkwardText) {
    const Typeface typeface = choose_typeface();
    const About about{.title = kAwkward, .description = "<script>"};
    pugi::xml_document svg;
    ASSERT_TRUE(svg.load_string(to_svg(awkward_drawing(), typeface, about).c_str()));
    const pugi::xml_node root = svg.child("svg");
    EXPECT_STREQ(root.child_value("title"), kAwkward);
    EXPECT_STREQ(root.child_value("desc"), "<script>");
    EXPECT_STREQ(root.child("image").child_value("title"), kAwkward);
    EXPECT_STREQ(root.child("path").attribute("aria-label").value(), kAwkward);
    EXPECT_THAT(root.child("path").attribute("d").value(), HasSubstr("C"));
    EXPECT_STREQ(root.attribute("width").value(), "200.000pt");
    pugi::xml_document html;
    EXPECT_THAT(to_html(awkward_drawing(), typeface, about),
                AllOf(HasSubstr("<title>a &amp; b &lt; c_d"), Not(HasSubstr("<script>"))));
}

TEST(Files, TexEscapesWhatItWouldRead) {
    const TexFiles files =
        to_tex(awkward_drawing(), choose_typeface(), "f_1", {.title = "t", .description = ""});
    EXPECT_THAT(files.tex, AllOf(HasSubstr(R"(a \& b $<$ c\_d \% \#1 \{x\})"),
                                 HasSubstr(R"(\textbackslash{} \textasciitilde{})"),
                                 HasSubstr(R"($\times$ -- ü)"), HasSubstr("{f_1-1.png}")));
    EXPECT_EQ(files.pictures.size(), 1U);
}

// As outlines as wide as it is measured, and in TeX no wider, whatever the paper's font.
TEST(Files, KeepLongTextWhole) {
    const Typeface typeface = choose_typeface();
    const std::string text =
        "a note that is long: far longer than ten times the size of its letters";
    const double width = text_width(typeface, text, 6, false);
    ASSERT_GT(width, 120);
    std::istringstream outline(text_outline(typeface, text, 6, false));
    double right = 0;
    for (std::string number; outline >> number;) {
        const std::size_t digits = number.find_last_of("MLCZ");
        if (digits != std::string::npos) number = number.substr(digits + 1);
        if (!number.empty()) right = std::max(right, std::stod(number));
    }
    EXPECT_NEAR(right, width, 1);
    Drawing drawing{.width = 300, .height = 50, .items = {}};
    drawing.items.push_back(Label{.at = {0, 10}, .text = text, .size = 6});
    EXPECT_THAT(to_tex(drawing, typeface, "f", {}).tex,
                HasSubstr("\\figurefit{" + fmt::format("{:.3f}bp", width) + "}{a note"));
}

TEST(Files, ArePlacedAlike) {
    Drawing drawing{.width = 100, .height = 50, .items = {}};
    drawing.items.push_back(Picture{{10, 20, 30, 15}, plain_raster(2, 1), ""});
    const std::string svg = to_svg(drawing, choose_typeface(), {});
    EXPECT_THAT(svg, HasSubstr(R"(<image x="10.000" y="20.000" width="30.000" height="15.000")"));
    const std::string tex = to_tex(drawing, choose_typeface(), "f", {}).tex;
    EXPECT_THAT(tex, AllOf(HasSubstr("at (10.000bp,-20.000bp)"),
                           HasSubstr("width=30.000bp, height=15.000bp")));
}

TEST(Files, AreRefusedByName) {
    for (const char* good : {"f.pdf", "f.svg", "a b.png", "f.html", "a-b_1.2.tex"}) {
        EXPECT_NO_THROW(require_format(good)) << good;
    }
    EXPECT_EQ(message_of(Errc::InvalidArgument, [] { require_format("a/f.jpg"); }),
              "write 'a/f.jpg': unknown extension; known: .pdf .svg .png .tex .html");
    EXPECT_THAT(message_of(Errc::InvalidArgument, [] { require_format("figure"); }),
                HasSubstr("unknown extension"));
    EXPECT_THAT(message_of(Errc::InvalidArgument, [] { require_format("100%.tex"); }),
                HasSubstr("for TeX a name must be of letters"));
    const Drawing high{.width = 100, .height = 9000, .items = {}};
    EXPECT_THAT(message_of(Errc::InvalidArgument, [&] { to_png(high, choose_typeface()); }),
                HasSubstr("too large for PNG"));
}

// --- figures of a store --------------------------------------------------------------------------

class FigureTest : public StoreTest {
 protected:
    void SetUp() override {
        store_.put_experiment(plan_);
        commit_all(store_, plan_);
        store_.measure(plan_);
    }
    Drawing figure(const std::string& panel, const std::string& before = "") {
        const auto file = files_.write("f.yaml", before + "panels:\n  - {" + panel + "}\n");
        return make_figure(store_, read_figure_file(file), choose_typeface());
    }
    std::string complaint(const std::string& panel) {
        const std::string message = message_of(Errc::InvalidArgument, [&] { figure(panel); });
        const std::string folder = files_.path().string() + "/";
        return message.starts_with(folder) ? message.substr(folder.size()) : message;
    }

    TemporaryFolder files_;
    Store store_ = open();
};

TEST_F(FigureTest, AComparisonHasImagesMapsNumbersAndSaysWhatTheyAre) {
    const Drawing drawing = figure(
        "kind: comparison, crops: [[1, 1, 4, 2]], maps: {metric: mse, range: [0, 0.1]}, "
        "full: [plain, clever], titles: {plain: Balance, Box: The box}");
    const std::vector<Picture> pictures = items_of<Picture>(drawing);
    std::vector<std::string> descriptions;
    for (const Picture& picture : pictures) descriptions.push_back(picture.description);
    EXPECT_THAT(descriptions,
                ElementsAre("The box", "reference, The box", "Balance, The box", "clever, The box",
                            "error of Balance, The box", "error of clever, The box",
                            "colour bar: MSE of a pixel, mean over seeds"));
    EXPECT_EQ(pictures[1].raster.width, 4);
    const Comparison comparison = compare(store_, plan_);
    EXPECT_THAT(texts_of(drawing), Contains("The box"));
    EXPECT_THAT(texts_of(drawing), Contains("relMSE, ratio to Balance"));
    EXPECT_THAT(
        texts_of(drawing),
        Contains("Numbers in images: mean MSE of what is shown, untrimmed, and its ratio to "
                 "Balance."));
    EXPECT_THAT(texts_of(drawing), Contains("baseline"));
    const Label* ratio = find_label(drawing, "×0.");
    ASSERT_NE(ratio, nullptr);
    EXPECT_EQ(drawing.width, kColumnWidth);
    // In the other direction.
    EXPECT_THAT(texts_of(figure("kind: comparison, ratio: gain")),
                Contains("Numbers below: relMSE, gain over plain."));
    EXPECT_EQ(comparison.baseline, "plain");
}

TEST_F(FigureTest, BoldIsTheClearBest) {
    const Drawing drawing = figure("kind: comparison, methods: [plain, clever]");
    std::vector<std::string> bold;
    for (const Label& label : items_of<Label>(drawing)) {
        if (label.bold) bold.push_back(label.text);
    }
    const Comparison comparison = compare(store_, plan_);
    ASSERT_TRUE(comparison.find("Box", "clever", SampleBudget{16})->differs());
    ASSERT_EQ(bold.size(), 2U);
    EXPECT_THAT(bold[1], HasSubstr("×"));
    EXPECT_NE(find_label(drawing, "Bold: best"), nullptr);
    const Drawing one = figure("kind: comparison, methods: [clever]");
    EXPECT_EQ(find_label(one, "Bold: best"), nullptr);
}

TEST_F(FigureTest, AParetoFrontGoesThroughWhatNothingBeats) {
    Plan ladder = made_up_plan("ladder", 3);
    for (Cell& cell : ladder.cells) {
        if (cell.role == Role::Test) cell.task.snapshots = SnapshotLadder{};
    }
    store_.put_experiment(ladder);
    commit_all(store_, ladder);
    store_.measure(ladder);
    const Drawing drawing = figure("kind: pareto, effort: passes, experiment: ladder");
    std::vector<Point> stairs;
    std::map<bool, std::vector<Point>> centres;  // of markers, by whether they are clever's
    for (const Shape& shape : items_of<Shape>(drawing)) {
        if (!shape.closed && shape.stroke == kGrey) stairs = shape.points;
        if (!shape.closed || shape.points.size() < 4 || !shape.fill) continue;
        Point centre;
        for (const Point& p : shape.points) {
            centre.x += p.x / static_cast<double>(shape.points.size());
            centre.y += p.y / static_cast<double>(shape.points.size());
        }
        centres[shape.fill == series_colour(1)].push_back(centre);
    }
    const auto is_on_stairs = [&stairs](const Point& centre) {
        return std::ranges::any_of(stairs, [&centre](const Point& p) {
            return std::hypot(p.x - centre.x, p.y - centre.y) < 0.01;
        });
    };
    ASSERT_EQ(centres[true].size(), 5U + 1);  // 1, 2, 4, 8 and 16 samples; the legend
    ASSERT_EQ(centres[false].size(), 5U + 1);
    EXPECT_EQ(std::ranges::count_if(centres[true], is_on_stairs), 5);
    EXPECT_EQ(std::ranges::count_if(centres[false], is_on_stairs), 0);
    EXPECT_THAT(texts_of(figure("kind: convergence, effort: passes, experiment: ladder")),
                AllOf(Contains("samples a pixel"), Contains("1/samples"), Contains("relMSE")));
}

// Both crops are the whole image.
TEST_F(FigureTest, NumbersInAutomaticCropsAreNotBold) {
    const auto bold_insets = [this](const std::string& crops) {
        const Drawing drawing =
            figure("kind: comparison, methods: [plain, clever], crops: " + crops);
        return std::ranges::count_if(items_of<Label>(drawing), [](const Label& label) {
            return label.bold && label.colour == kWhite;
        });
    };
    EXPECT_EQ(bold_insets("[[0, 0, 8, 4]]"), 1);
    EXPECT_EQ(bold_insets("{auto: 1, size: [8, 4]}"), 0);
}

TEST_F(FigureTest, AMissingIntervalIsSaid) {
    const Plan two = made_up_plan("two", 2);
    store_.put_experiment(two);
    commit_all(store_, two);
    store_.measure(two);
    EXPECT_THAT(texts_of(figure("kind: comparison, experiment: two")),
                Contains("No interval: fewer than 3 seeds."));
    EXPECT_THAT(texts_of(figure("kind: comparison, experiment: first")),
                Not(Contains(HasSubstr("No interval"))));
}

TEST_F(FigureTest, MissingRunsAreSaid) {
    Plan longer = made_up_plan("longer", 4);
    longer.scenes.push_back({.name = "Other", .exposure = 0});
    for (Cell cell : made_up_plan("longer", 1).cells) {
        cell.scene = cell.task.scene = "Other";
        cell.task.scene_hash = sha256_hex("another box");
        longer.cells.push_back(cell);
    }
    store_.put_experiment(longer);
    const Drawing drawing = figure("kind: comparison, crops: [[0, 0, 2, 2]], experiment: longer");
    EXPECT_EQ(std::ranges::count(texts_of(drawing), "no run"), 3);  // of the other scene
    EXPECT_THAT(texts_of(drawing), Contains("3 of 4 seeds: 1 unfinished"));
    EXPECT_THAT(texts_of(figure("kind: convergence, experiment: longer")),
                Contains("Other: no run"));
    EXPECT_NE(figure("kind: bars, experiment: longer").items.size(), 0U);
    EXPECT_EQ(
        complaint("kind: comparison, crops: {auto: 1, size: [2, 2]}, experiment: longer"),
        "f.yaml:2:31: automatic crops need runs of two methods and the reference, which scene "
        "'Other' does not have yet");
}

TEST_F(FigureTest, NamesAreThoseOfTheExperiment) {
    EXPECT_EQ(complaint("kind: bars, scenes: Hall"),
              "f.yaml:2:26: unknown scene 'Hall'; known: Box");
    EXPECT_EQ(complaint("kind: bars, methods: [plain, dull]"),
              "f.yaml:2:35: unknown method 'dull'; known: plain clever");
    EXPECT_EQ(complaint("kind: bars, methods: reference"),
              "f.yaml:2:27: unknown method 'reference'; known: plain clever");
    EXPECT_EQ(complaint("kind: bars, budget: 8 spp"),
              "f.yaml:2:26: unknown budget '8 spp'; known: '16 spp'");
    EXPECT_EQ(complaint("kind: bars, titles: {Bocks: The box}"),
              "f.yaml:2:27: unknown name in titles 'Bocks'; known: Box plain clever reference");
    EXPECT_THAT(complaint("kind: bars, metric: flip"),
                AllOf(HasSubstr("f.yaml:2:26: experiment 'first' does not measure 'flip'; known: "
                                "relmse.eps0.01 mse")));
    EXPECT_THAT(complaint("kind: comparison, maps: {metric: mean}"),
                HasSubstr("f.yaml:2:39: metric 'mean' has no value by pixel"));
    EXPECT_THAT(complaint("kind: comparison, maps: {metric: noise}"),
                AllOf(HasSubstr("f.yaml:2:39: "), HasSubstr("noise"), HasSubstr("known")));
    EXPECT_EQ(complaint("kind: comparison, methods: plain, full: clever"),
              "f.yaml:2:46: 'clever' is not among the panel's methods: plain");
    EXPECT_EQ(complaint("kind: comparison, crops: [[5, 0, 4, 4]]"),
              "f.yaml:2:32: a crop does not fit into the image of scene 'Box', 8 x 4");
    EXPECT_EQ(complaint("kind: comparison, crops: {auto: 1, size: [4, 5]}"),
              "f.yaml:2:31: a crop does not fit into the image of scene 'Box', 8 x 4");
    EXPECT_THAT(
        complaint("kind: sweep, parameter: radius"),
        HasSubstr("f.yaml:2:30: method 'plain' has no parameter 'radius'; known: max_depth"));
}

TEST_F(FigureTest, AutomaticCropsNeedAMapAndTwoMethods) {
    EXPECT_EQ(
        complaint("kind: comparison, metric: cpu_seconds, crops: {auto: 1, size: [2, 2]}"),
        "f.yaml:2:52: automatic crops need a metric with a value by pixel, which 'cpu_seconds' "
        "is not; give another as 'metric', or the crops");
    EXPECT_EQ(complaint("kind: comparison, methods: [reference, plain], "
                        "crops: {auto: 1, size: [2, 2]}"),
              "f.yaml:2:60: automatic crops need two methods to compare");
    const Drawing drawing = figure(
        "kind: comparison, metric: cpu_seconds, maps: {metric: mse}, crops: {auto: 1, size: [2, "
        "2]}");
    EXPECT_EQ(items_of<Picture>(drawing).size(), 1U + 3 + 2 + 1);
}

// Without a metric that is its own, what is wrong is said of the panel.
TEST_F(FigureTest, AnErrorAlwaysHasAPlace) {
    Plan none = plan_;
    none.experiment = "none";
    none.metrics.clear();
    store_.put_experiment(none);
    EXPECT_THAT(complaint("kind: bars, experiment: none"),
                HasSubstr("f.yaml:2:5: experiment 'none' does not measure"));
    Plan two = plan_;
    two.experiment = "two";
    two.budgets.push_back(SampleBudget{8});
    store_.put_experiment(two);
    EXPECT_EQ(complaint("kind: bars, experiment: two"),
              "f.yaml:2:5: the experiment has several budgets, of which the panel needs one as "
              "'budget'; known: '16 spp' '8 spp'");
}

TEST_F(FigureTest, BarsStandOnOneAndLeaveTheBaselineOut) {
    const Drawing drawing = figure("kind: bars");
    std::vector<Box> bars;
    for (const Shape& shape : items_of<Shape>(drawing)) {
        if (shape.fill == series_colour(1) && !shape.stroke) bars.push_back(box_of(shape));
    }
    ASSERT_EQ(bars.size(), 1U);
    EXPECT_GT(bars[0].height, 5);  // a ratio of about a quarter hangs from one
    EXPECT_EQ(find_label(drawing, "plain")->text, "relMSE relative to plain");
    EXPECT_THAT(texts_of(drawing), Contains("clever"));
}

TEST_F(FigureTest, NamesOfManyScenesAreTurnedToBeRead) {
    Plan many = made_up_plan("many", 3);
    const std::vector<Cell> cells = many.cells;
    for (int i = 0; i < 20; ++i) {
        const std::string name = "AScene/WithALongName" + std::to_string(i);
        many.scenes.push_back({.name = name, .exposure = 0});
        for (Cell cell : cells) {
            cell.scene = name;
            many.cells.push_back(cell);
        }
    }
    store_.put_experiment(many);
    const Drawing drawing = figure("kind: bars", "width: page\n");
    const Label* name = find_label(drawing, "LongName7");
    ASSERT_NE(name, nullptr);
    EXPECT_TRUE(name->upwards);
    EXPECT_GT(name->size, 5);
    EXPECT_LT(box_of(*name, choose_typeface()).bottom(), find_label(drawing, "clever")->at.y);
}

TEST_F(FigureTest, TheSameStoreGivesTheSameBytesInEveryFormat) {
    const std::string panel =
        "kind: comparison, crops: {auto: 1, size: [2, 2]}, maps: {metric: mse}";
    const Drawing one = figure(panel);
    const Drawing two = figure(panel);
    const Typeface typeface = choose_typeface();
    EXPECT_EQ(to_pdf(one, typeface, {}), to_pdf(two, typeface, {}));
    EXPECT_EQ(to_png(one, typeface), to_png(two, typeface));
    EXPECT_EQ(to_svg(one, typeface, {}), to_svg(two, typeface, {}));
    EXPECT_EQ(to_tex(one, typeface, "f", {}).tex, to_tex(two, typeface, "f", {}).tex);
}

}  // namespace
}  // namespace misbench::figure
