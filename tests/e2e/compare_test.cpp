// misbench compare as a process: image files, no store.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <nlohmann/json.hpp>

#include "renderer/image/image.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace misbench {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

Image filled(float value, int width = 8, int height = 6) {
    Image image(width, height);
    std::ranges::fill(image.rgb, value);
    return image;
}

class CompareTest : public testing::Test {
 protected:
    std::string file(const std::string& name) const { return (folder_.path() / name).string(); }

    std::string write(const std::string& name, const Image& image) const {
        write_exr(file(name), image);
        return file(name);
    }

    Outcome compare(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), {MISBENCH_PROGRAM, "compare"});
        return Process(arguments, folder_.path()).wait();
    }

    nlohmann::json compared(std::vector<std::string> arguments) const {
        arguments.insert(arguments.end(), {"--format", "json"});
        const Outcome outcome = compare(arguments);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return nlohmann::json::parse(outcome.out);
    }

    void expect_error(const Outcome& outcome, const std::string& message) const {
        EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
        EXPECT_THAT(outcome.err, AllOf(StartsWith("misbench: error: "), HasSubstr(message)));
        EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
        EXPECT_EQ(outcome.out, "");
    }

    TemporaryFolder folder_;
};

TEST_F(CompareTest, PrintsOneLineAnImageAndItsRatiosToTheFirst) {
    const std::string a = write("a.exr", filled(1.5F));
    const std::string b = write("b.exr", filled(2.0F));
    const std::string r = write("r.exr", filled(1.0F));
    const Outcome text = compare({a, b, "--reference", r});
    EXPECT_EQ(text.exit_code, 0) << text.err;
    EXPECT_THAT(text.out,
                AllOf(HasSubstr("relmse.eps0.01.trim0.001"), HasSubstr("smape.eps0.01"),
                      HasSubstr("flip.ldr.ppd67"), HasSubstr("flip.hdr.ppd67"),
                      HasSubstr("luminance.rec709.bias.eps1e-9"), HasSubstr(a + "  0.2475"),
                      HasSubstr(b + "  0.9901"), HasSubstr("×4"), HasSubstr("naive")));
    const auto json = compared({a, b, "--reference", r, "--metric", "mse", "--metric", "mean"});
    EXPECT_EQ(json["images"][0]["metrics"], (nlohmann::json{{"mse", 0.25}, {"mean", 1.5}}));
    EXPECT_FALSE(json["images"][0].contains("ratios"));
    EXPECT_EQ(json["images"][1]["ratios"], nlohmann::json({{"mse", 4.0}}));  // none of the mean
    EXPECT_EQ(json["naive"], true);
}

TEST_F(CompareTest, NoiseOfTheReferenceCancelsBetweenTwoHalves) {
    const std::string image = write("i.exr", filled(1.0F));
    const std::string a = write("a.exr", filled(1.25F));
    const std::string b = write("b.exr", filled(0.5F));
    const std::vector<std::string> arguments{image, "--reference", a,    "--reference-b",
                                             b,     "--metric",    "mse"};
    const auto json = compared(arguments);
    EXPECT_EQ(json["naive"], false);
    EXPECT_EQ(json["images"][0]["metrics"]["mse"], -0.25 * 0.5);
    const Outcome text = compare(arguments);
    EXPECT_THAT(text.out, AllOf(HasSubstr("noise cancels"), HasSubstr("noisy reference: "),
                                Not(HasSubstr("naive"))));
    // The same image twice is no second half.
    const auto twice = compared({image, "--reference", a, "--reference-b", a, "--metric", "mse"});
    EXPECT_EQ(twice["naive"], true);
    EXPECT_FALSE(twice["images"][0].contains("reference_noise_shares"));
}

TEST_F(CompareTest, WritesCsvAndMarkdownForOtherPrograms) {
    const std::string a = write("a.exr", filled(1.5F));
    const std::string r = write("r.exr", filled(1.0F));
    EXPECT_EQ(compare({a, a, "--reference", r, "--metric", "mse", "--format", "csv"}).out,
              "image,mse,ratio.mse,naive\n" + a + ",0.25,,1\n" + a + ",0.25,1,1\n");
    EXPECT_THAT(compare({a, "--reference", r, "--metric", "mse", "--format", "markdown"}).out,
                AllOf(StartsWith("| image | mse |\n|---|---:|\n| "), HasSubstr(" | 0.25 |\n")));
}

TEST_F(CompareTest, MapsAreOfOneImageByOneMetric) {
    Image image = filled(1.0F);
    image.rgb[3 * 11] = 4.0F;
    const std::string a = write("a.exr", image);
    const std::string r = write("r.exr", filled(1.0F));
    const std::string map = file("map.exr");
    EXPECT_EQ(compare({a, "--reference", r, "--metric", "mse", "--map", map}).exit_code, 0);
    Image expected = filled(0.0F);
    for (std::size_t c = 0; c < 3; ++c) expected.rgb[3 * 11 + c] = 3.0F;  // 9 over three channels
    EXPECT_EQ(read_exr(map), expected);
    const std::string png = file("map.png");
    EXPECT_EQ(compare({a, "--reference", r, "--metric", "mse", "--map", png}).exit_code, 0);
    EXPECT_THAT(slurp(png), StartsWith("\x89PNG"));
    expect_error(compare({a, a, "--reference", r, "--metric", "mse", "--map", map}),
                 "a map is of one image by one --metric, not of 2 by 1");
    expect_error(compare({a, "--reference", r, "--map", map}), "not of 1 by 0");
    expect_error(compare({a, "--reference", r, "--metric", "mean", "--map", map}), "map mean");
    expect_error(compare({a, "--reference", r, "--metric", "mse", "--map", file("map.jpg")}),
                 "known: .exr .png");
}

TEST_F(CompareTest, ReadsTheFilesOfOtherProgramsAndSaysWhatItTakesForGranted) {
    const std::string r = write("r.exr", filled(0.5F, 2, 1));
    std::ofstream(file("eight-bit.png"), std::ios::binary) << encode_png(filled(0.5F, 2, 1), 0);
    std::string grey = "Pf\n2 1\n-1.0\n";
    for (const float value : {0.5F, 0.5F}) {
        const auto bits = std::bit_cast<std::array<char, 4>>(value);
        grey.append(bits.data(), 4);
    }
    std::ofstream(file("grey.pfm"), std::ios::binary) << grey;
    const auto json =
        compared({file("eight-bit.png"), file("grey.pfm"), "--reference", r, "--metric", "mean"});
    EXPECT_NEAR(json["images"][0]["metrics"]["mean"].get<double>(), 0.5, 0.005);
    EXPECT_EQ(json["images"][1]["metrics"]["mean"], 0.5);
    const std::string notes = json["notes"].dump();
    EXPECT_THAT(notes, HasSubstr("eight-bit.png: taken as sRGB"));
    EXPECT_THAT(notes, Not(HasSubstr("grey.pfm")));
}

TEST_F(CompareTest, TakesALayerOfFilesThatHaveSome) {
    const Image beauty = filled(1.5F);
    const Image albedo = filled(0.25F);
    write_exr_layers(file("layers.exr"),
                     std::array{ImageLayer{"albedo", &albedo}, ImageLayer{"beauty", &beauty}});
    const std::string r = file("layers.exr");
    const auto json = compared({r, "--reference", r, "--layer", "beauty", "--metric", "mean"});
    EXPECT_EQ(json["images"][0]["metrics"]["mean"], 1.5);
    expect_error(compare({r, "--reference", r}), "its layers: albedo beauty");
    expect_error(compare({r, "--reference", r, "--layer", "Beauty"}),
                 "it has no layer 'Beauty' of R G B or Y; its layers: albedo beauty");
}

TEST_F(CompareTest, RefusesInOneLineWhatCannotBeCompared) {
    const std::string a = write("a.exr", filled(1.0F));
    const std::string r = write("r.exr", filled(1.0F));
    const std::string small = write("small.exr", filled(1.0F, 6, 8));
    Image bad = filled(1.0F);
    bad.rgb[3 * 21 + 2] = std::numeric_limits<float>::quiet_NaN();
    bad.rgb[3 * 40] = std::numeric_limits<float>::infinity();
    const std::string nan = write("nan.exr", bad);
    std::ofstream(file("text.exr")) << "no image";

    expect_error(compare({small, "--reference", r}),
                 "small.exr': it is 6x8, and the reference '" + r + "' 8x6");
    expect_error(compare({a, "--reference", r, "--reference-b", small}), "small.exr': it is 6x8");
    expect_error(compare({nan, "--reference", r}),
                 "nan.exr': 2 of its 48 pixels are not finite, the first at 5,2");
    expect_error(compare({a, "--reference", nan}), "nan.exr': 2 of its 48 pixels");
    expect_error(compare({file("text.exr"), "--reference", r}), "text.exr': ");
    expect_error(compare({file("none.exr"), "--reference", r}), "none.exr': no such file");
    expect_error(compare({folder_.path().string(), "--reference", r}), "read '");
    expect_error(compare({a, "--reference", r, "--metric", "psnr"}), "unknown metric 'psnr'");
    expect_error(compare({a}), "--reference is required");
    expect_error(compare({a, "--reference", r, "--format", "pdf"}), "pdf");
}

}  // namespace
}  // namespace misbench
