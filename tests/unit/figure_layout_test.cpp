// Where a figure's parts lie: colours, crops, axes, grids.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "experiments/figure/auto_crops.h"
#include "experiments/figure/axes.h"
#include "experiments/figure/colour_map.h"
#include "experiments/figure/grid.h"
#include "tests/support/drawings.h"
#include "tests/support/store_fixture.h"

namespace misbench::figure {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

ValueMap plain_map(int width, int height, double value) {
    return {width, height, std::vector<double>(static_cast<std::size_t>(width * height), value)};
}

void set(ValueMap& map, const Window& window, double value) {
    for (int y = window.y; y < window.y + window.height; ++y) {
        for (int x = window.x; x < window.x + window.width; ++x) {
            map.values[static_cast<std::size_t>(y * map.width + x)] = value;
        }
    }
}

// --- colours -------------------------------------------------------------------------------------

TEST(ColourMap, GoesFromBlackToLightInEqualStepsOfLightness) {
    const auto luminance = [](const Colour& c) {
        const auto linear = [](double x) {
            return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
        };
        return 0.2126 * linear(c.red) + 0.7152 * linear(c.green) + 0.0722 * linear(c.blue);
    };
    EXPECT_LT(luminance(false_colour(0)), 0.005);
    EXPECT_GT(luminance(false_colour(1)), 0.85);
    for (int i = 0; i < 256; ++i) {
        const Colour colour = false_colour(i / 255.0);
        for (const double channel : {colour.red, colour.green, colour.blue}) {
            EXPECT_GE(channel, 0) << i;
            EXPECT_LE(channel, 1) << i;
        }
        // Lightness in Oklab is about the cube root of luminance.
        EXPECT_NEAR(std::cbrt(luminance(colour)), 0.08 + (0.97 - 0.08) * i / 255.0, 0.08) << i;
        if (i == 0) continue;
        EXPECT_GT(luminance(colour), luminance(false_colour((i - 1) / 255.0))) << i;
    }
}

TEST(ColourMap, ShowsWhatLiesOutsideAsItsEnds) {
    const ColourScale linear{1, 3, false};
    EXPECT_EQ(linear.position(1), 0);
    EXPECT_EQ(linear.position(2), 0.5);
    EXPECT_EQ(linear.position(-5), 0);
    EXPECT_EQ(linear.position(99), 1);
    EXPECT_EQ(linear.position(std::nan("")), 0);
    const ColourScale logarithmic{0.01, 1, true};
    EXPECT_NEAR(logarithmic.position(0.1), 0.5, 1e-12);
    EXPECT_EQ(logarithmic.position(0), 0);
    EXPECT_EQ(logarithmic.position(-1), 0);
    EXPECT_EQ(logarithmic.position(HUGE_VAL), 1);
    const Raster ends = to_raster(ValueMap{3, 1, {0.01, 1, 1e9}}, logarithmic);
    const auto bytes = [](const Colour& c) {
        const auto byte = [](double x) { return static_cast<std::uint8_t>(std::lround(255 * x)); };
        return std::vector<std::uint8_t>{byte(c.red), byte(c.green), byte(c.blue)};
    };
    const auto pixel = [&ends](std::ptrdiff_t i) {
        return std::vector<std::uint8_t>(ends.rgb.begin() + 3 * i, ends.rgb.begin() + 3 * i + 3);
    };
    EXPECT_EQ(pixel(0), bytes(false_colour(0)));
    EXPECT_EQ(pixel(1), bytes(false_colour(1)));
    EXPECT_EQ(pixel(2), bytes(false_colour(1)));
}

TEST(ColourMap, TakesItsScaleFromTheMapsButForOutliers) {
    ValueMap map = plain_map(100, 100, 0.034);
    map.values[5] = 1e6;
    map.values[6] = -3;
    map.values[7] = std::nan("");
    map.values[8] = 1e-9;
    const ColourScale linear = scale_of({&map}, false);
    EXPECT_EQ(linear.low, 0);
    EXPECT_DOUBLE_EQ(linear.high, 0.04);
    const ColourScale logarithmic = scale_of({&map}, true);
    EXPECT_TRUE(logarithmic.logarithmic);
    EXPECT_DOUBLE_EQ(logarithmic.low, 0.03);
    EXPECT_DOUBLE_EQ(logarithmic.high, 0.04);
    const ValueMap black = plain_map(2, 2, 0);
    for (const bool is_logarithmic : {false, true}) {
        const ColourScale scale = scale_of({&black}, is_logarithmic);
        EXPECT_EQ(scale.high, 1);
        EXPECT_EQ(scale.position(0), 0);
    }
}

TEST(SeriesColours, AreAllDifferentForTwelve) {
    for (std::size_t a = 0; a < 12; ++a) {
        for (std::size_t b = 0; b < a; ++b) {
            EXPECT_FALSE(series_colour(a) == series_colour(b)) << a << " " << b;
        }
    }
}

TEST(Markers, AreAllDifferentForTwelve) {
    std::vector<Shape> shapes;
    for (std::size_t i = 0; i < 12; ++i) {
        Drawing drawing;
        add_marker(drawing, {0, 0}, i, {0, 0, 1});
        shapes.push_back(items_of<Shape>(drawing).at(0));
        for (std::size_t k = 0; k < i; ++k) {
            const bool same_outline = std::ranges::equal(
                shapes[i].points, shapes[k].points,
                [](Point a, Point b) { return std::hypot(a.x - b.x, a.y - b.y) < 0.1; });
            EXPECT_FALSE(same_outline && shapes[i].fill == shapes[k].fill) << i << " " << k;
        }
    }
}

// --- rasters and crops ---------------------------------------------------------------------------

TEST(Raster, IsCutAndSplit) {
    Raster raster{3, 2, {}};
    for (std::uint8_t i = 0; i < 18; ++i) raster.rgb.push_back(i);
    EXPECT_EQ(cut(raster, {1, 1, 2, 1}), (Raster{2, 1, {12, 13, 14, 15, 16, 17}}));
    const Raster both = split(plain_raster(5, 2, 1), plain_raster(5, 2, 9));
    EXPECT_EQ(std::ranges::count(both.rgb, 1), 2 * 3 * 2);
    EXPECT_EQ(both.rgb[5], 1);
    EXPECT_EQ(both.rgb[6], 9);
    EXPECT_DOUBLE_EQ(mean_within(ValueMap{3, 1, {1, 2, 6}}, {1, 0, 2, 1}), 4);
}

TEST(AutoCrops, FindAPlantedDifference) {
    const ValueMap a = plain_map(64, 48, 0.1);
    ValueMap b = a;
    const Window large{40, 6, 12, 9};
    const Window small{5, 30, 12, 9};
    set(b, large, 0.9);
    set(b, small, 0.0);
    // Brighter than all, but a pixel's: no reason to look there.
    b.values[20 * 64 + 20] = 1e5;
    const std::vector<Window> crops = auto_crops(a, b, 12, 9, 2);
    EXPECT_THAT(crops, ElementsAre(large, small));
    EXPECT_EQ(auto_crops(b, a, 12, 9, 2), crops);
}

TEST(AutoCrops, KeepApartAndAreFewerWhereThereIsNoRoom) {
    const ValueMap a = plain_map(20, 10, 0);
    ValueMap b = a;
    set(b, {0, 0, 20, 10}, 1);
    for (const Window& one : auto_crops(a, b, 5, 5, 8)) {
        for (const Window& other : auto_crops(a, b, 5, 5, 8)) {
            if (one == other) continue;
            EXPECT_TRUE(std::abs(one.x - other.x) >= 7.5 || std::abs(one.y - other.y) >= 7.5);
        }
        EXPECT_TRUE(one.x + one.width <= 20 && one.y + one.height <= 10);
    }
    EXPECT_EQ(auto_crops(a, b, 20, 10, 3).size(), 1U);
}

// --- axes ----------------------------------------------------------------------------------------

std::vector<std::string> labels_of(const Axis& axis) {
    std::vector<std::string> labels;
    for (const Tick& tick : ticks(axis)) {
        EXPECT_GE(axis.position(tick.value), -1e-9) << tick.value;
        EXPECT_LE(axis.position(tick.value), 1 + 1e-9) << tick.value;
        if (!tick.label.empty()) labels.push_back(tick.label);
    }
    return labels;
}

TEST(Axes, HaveRoundTicks) {
    EXPECT_THAT(labels_of({.low = 0, .high = 1}), ElementsAre("0", "0.5", "1"));
    EXPECT_THAT(labels_of({.low = -0.1, .high = 0.3}),
                ElementsAre("-0.1", "0", "0.1", "0.2", "0.3"));
    EXPECT_THAT(labels_of({.low = 0, .high = 2e6}), ElementsAre("0", "5e5", "1e6", "1.5e6", "2e6"));
    EXPECT_THAT(labels_of({.low = 0.5, .high = 200, .logarithmic = true}),
                ElementsAre("1", "10", "100"));
    EXPECT_THAT(labels_of({.low = 0.8, .high = 12, .logarithmic = true}),
                ElementsAre("1", "2", "5", "10"));
    EXPECT_THAT(labels_of({.low = 1e-12, .high = 1, .logarithmic = true}),
                AllOf(Contains("1e-12"), Contains("1"), testing::SizeIs(testing::Le(8))));
}

// However short a logarithmic axis is, something is written at it.
TEST(Axes, HaveTwoLabelsAtLeast) {
    for (const auto& [low, high] :
         {std::pair{0.97, 1.03}, std::pair{0.0051, 0.0059}, std::pair{1.1, 1.9},
          std::pair{3.0, 8.0}, std::pair{0.5, 700.0}, std::pair{1e-7, 1e9}, std::pair{6.0, 70.0}}) {
        EXPECT_GE(labels_of({.low = low, .high = high, .logarithmic = true}).size(), 2U)
            << low << " " << high;
        EXPECT_GE(labels_of({.low = low, .high = high}).size(), 2U) << low << " " << high;
    }
}

TEST(Axes, SurroundTheirValuesEvenWhereAllAreEqual) {
    for (const bool is_logarithmic : {false, true}) {
        for (const std::vector<double>& values :
             {std::vector<double>{3}, std::vector<double>{2, 2}, std::vector<double>{1e-6, 1e3}}) {
            const Axis axis = axis_around(values, is_logarithmic, "");
            for (const double value : values) {
                EXPECT_GT(axis.position(value), 0);
                EXPECT_LT(axis.position(value), 1);
            }
        }
    }
    const Axis zero = axis_around(std::vector<double>{0}, false, "");
    EXPECT_LT(zero.low, zero.high);
}

TEST(Plots, CutALineAtTheFrame) {
    Drawing drawing;
    const Style style{.typeface = choose_typeface()};
    const Plot plot(drawing, style, {0, 0, 200, 100}, {.low = 1, .high = 100, .logarithmic = true},
                    {.low = 1, .high = 100, .logarithmic = true}, "title");
    const std::vector<Point> ends = plot.clipped({10, 10}, {10'000, 0.01});
    ASSERT_EQ(ends.size(), 2U);
    EXPECT_NEAR(ends[0].x, plot.at(10, 10).x, 1e-9);
    EXPECT_NEAR(ends[1].x, plot.inner().right(), 1e-9);
    EXPECT_NEAR(ends[1].y, plot.inner().bottom(), 1e-9);
    EXPECT_THAT(plot.clipped({200, 2}, {300, 3}), IsEmpty());
}

TEST(Plots, LabelsOfTicksDoNotTouch) {
    const Style style{.typeface = choose_typeface()};
    for (const double high : {2.0, 8.0, 90.0, 1e5, 1e12}) {
        Drawing drawing;
        const Axis axis{.low = 0.011, .high = 0.011 * high, .logarithmic = true};
        const Plot plot(drawing, style, {0, 0, 90, 60}, axis, axis, "");
        const std::vector<Label> labels = items_of<Label>(drawing);
        ASSERT_FALSE(labels.empty());
        for (std::size_t a = 0; a < labels.size(); ++a) {
            const Box one = box_of(labels[a], style.typeface);
            for (std::size_t b = 0; b < a; ++b) {
                const Box other = box_of(labels[b], style.typeface);
                EXPECT_FALSE(overlap(one, other))
                    << labels[a].text << " and " << labels[b].text << " up to " << high;
            }
        }
    }
}

// --- grids ---------------------------------------------------------------------------------------

Grid crop_grid() {
    SceneBlock block{.title = "Box", .full = plain_raster(64, 48)};
    block.marks = {{{8, 6, 16, 12}, series_colour(0)}, {{40, 30, 16, 12}, series_colour(1)}};
    for (const Mark& mark : block.marks) {
        GridRow row{.aspect = 16.0 / 12, .cells = {}};
        for (int c = 0; c < 3; ++c) {
            row.cells.push_back({.raster = plain_raster(16, 12), .frame = mark.colour});
        }
        block.rows.push_back(row);
    }
    block.captions = {{{"0.1"}}, {{"0.2"}}, {{"0.3"}}};
    return {.columns = {"a", "b", "c"}, .blocks = {block}};
}

TEST(Grid, MarksTheImageWhereTheCropIs) {
    Drawing drawing;
    const Style style{.width = kPageWidth, .typeface = choose_typeface()};
    draw_grid(drawing, style, crop_grid(), 10);
    const std::vector<Picture> pictures = items_of<Picture>(drawing);
    ASSERT_EQ(pictures.size(), 1U + 6);
    const Box& full = pictures[0].box;
    EXPECT_NEAR(full.width / full.height, 64.0 / 48, 1e-9);
    std::vector<Box> marks;
    for (const Shape& shape : items_of<Shape>(drawing)) {
        if (shape.stroke == series_colour(0) || shape.stroke == series_colour(1)) {
            marks.push_back(box_of(shape));
        }
    }
    ASSERT_EQ(marks.size(), 2U + 6);  // in the image, and around each crop
    const double scale = full.width / 64;
    for (const auto& [mark, x, y] : {std::tuple{0, 8, 6}, std::tuple{1, 40, 30}}) {
        const Box& box = marks[static_cast<std::size_t>(mark)];
        // The stroke of one point lies within.
        EXPECT_NEAR(box.x, full.x + scale * x + 0.5, 1e-9);
        EXPECT_NEAR(box.y, full.y + scale * y + 0.5, 1e-9);
        EXPECT_NEAR(box.width, scale * 16 - 1, 1e-9);
        EXPECT_NEAR(box.height, scale * 12 - 1, 1e-9);
    }
}

TEST(Grid, FillsTheWidthAndNothingLiesOverAnother) {
    const Style style{.width = kPageWidth, .typeface = choose_typeface()};
    Drawing drawing{.width = style.width, .height = 0, .items = {}};
    drawing.height = draw_grid(drawing, style, crop_grid(), 0);
    std::vector<Box> boxes;
    for (const Picture& picture : items_of<Picture>(drawing)) boxes.push_back(picture.box);
    double right = 0;
    for (const Box& box : boxes) right = std::max(right, box.right());
    EXPECT_NEAR(right, style.width, 1e-6);
    EXPECT_NEAR(boxes[0].x, 0, 1e-6);
    EXPECT_NEAR(boxes[0].height, boxes[6].bottom() - boxes[1].y, 1e-6);  // as high as the crops
    for (const Label& label : items_of<Label>(drawing)) {
        boxes.push_back(box_of(label, style.typeface));
        EXPECT_GE(boxes.back().x, -1e-6) << label.text;
        EXPECT_LE(boxes.back().right(), style.width + 1e-6) << label.text;
        EXPECT_LE(boxes.back().bottom(), drawing.height) << label.text;
    }
    for (std::size_t a = 0; a < boxes.size(); ++a) {
        for (std::size_t b = 0; b < a; ++b) {
            EXPECT_FALSE(
                boxes[a].x < boxes[b].right() - 1e-6 && boxes[b].x < boxes[a].right() - 1e-6 &&
                boxes[a].y < boxes[b].bottom() - 1e-6 && boxes[b].y < boxes[a].bottom() - 1e-6)
                << a << " and " << b;
        }
    }
}

// Of texts beside each other the longest decides.
TEST(Grid, HasTextOfOneSizeThatFits) {
    const Style style{.typeface = choose_typeface()};
    Grid grid = crop_grid();
    grid.columns[1] = "a title of some length that is";
    grid.blocks[0].captions[2] = {{"×0.0095 [0.0078, 0.0114] and more"}};
    grid.blocks[0].rows[0].cells[0].inset = {.text = "1.23456 (×12345.67) and more"};
    grid.blocks[0].rows[1].cells[2].inset = {.text = "1"};
    Drawing drawing;
    draw_grid(drawing, style, grid, 0);
    const std::vector<Picture> pictures = items_of<Picture>(drawing);
    const auto size = [&drawing](const std::string& text) {
        return find_label(drawing, text)->size;
    };
    EXPECT_EQ(size("a title"), size("c"));
    EXPECT_EQ(size("×0.0095"), size("0.1"));
    EXPECT_EQ(size("1.23456"), items_of<Label>(drawing).at(4).size);
    for (const auto& [text, cell] :
         {std::pair{"a title", 2U}, std::pair{"×0.0095", 3U}, std::pair{"1.23456", 1U}}) {
        const Box box = box_of(*find_label(drawing, text), style.typeface);
        EXPECT_GE(box.x, pictures[cell].box.x - 0.1) << text;
        EXPECT_LE(box.right(), pictures[cell].box.right() + 0.1) << text;
    }
}

TEST(Grid, RefusesMoreColumnsThanCanBeSeen) {
    Grid grid;
    grid.columns.assign(60, "a");
    GridRow row;
    row.cells.resize(60);
    grid.blocks = {{.rows = {row}}};
    Drawing drawing;
    const Style style{.typeface = choose_typeface()};
    EXPECT_THAT(message_of(Errc::InvalidArgument, [&] { draw_grid(drawing, style, grid, 0); }),
                HasSubstr("60 columns of images do not fit into 240 pt"));
}

TEST(Grid, MakesTextSmallerThatDoesNotFit) {
    Drawing drawing;
    const Style style{.typeface = choose_typeface()};
    add_fitting(drawing, style, {.at = {}, .text = "short"}, 100);
    add_fitting(drawing, style,
                {.at = {}, .text = "a text that is much too long for so little room"}, 50);
    const std::vector<Label> labels = items_of<Label>(drawing);
    EXPECT_EQ(labels[0].size, 7);
    EXPECT_LT(labels[1].size, 4);
    EXPECT_NEAR(box_of(labels[1], style.typeface).width, 50, 0.5);
}

}  // namespace
}  // namespace misbench::figure
