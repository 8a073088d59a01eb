#include "renderer/image/image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <fstream>
#include <limits>

#include "renderer/base/error.h"
#include "renderer/base/files.h"
#include "tests/support/exr_layers.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;

class ImageFile : public testing::Test {
 protected:
    void TearDown() override { fs::remove(path_); }
    fs::path path_ =
        fs::temp_directory_path() / ("misbench_" + std::to_string(::getpid()) + ".exr");
};

Image gradient(int width, int height) {
    Image image(width, height);
    for (std::size_t i = 0; i < image.rgb.size(); ++i) {
        image.rgb[i] = 0.1F * static_cast<float>(i) - 1;
    }
    return image;
}

TEST_F(ImageFile, ComesBackBitByBit) {
    Image image = gradient(7, 3);
    image.rgb[4] = std::numeric_limits<float>::infinity();
    image.rgb[5] = 1e-42F;
    write_exr(path_, image, {{"scene", "Box"}});
    EXPECT_EQ(read_exr(path_), image);
}

TEST_F(ImageFile, OfSeveralLayersHasEachUnderItsName) {
    const Image all = gradient(7, 3);
    Image part = gradient(7, 3);
    for (float& value : part.rgb) value *= 0.5F;
    part.rgb[8] = std::numeric_limits<float>::infinity();
    write_exr_layers(path_,
                     std::array{ImageLayer{"weighted.n4.connect2", &part},
                                ImageLayer{"unweighted.n4.connect2", &all}, ImageLayer{"", &all}},
                     {{"scene", "Box"}});
    EXPECT_EQ(test::exr_layers(path_),
              (std::map<std::string, Image>{
                  {"", all}, {"unweighted.n4.connect2", all}, {"weighted.n4.connect2", part}}));
    EXPECT_EQ(read_exr(path_), all);
}

TEST_F(ImageFile, ThatPromisesMorePixelsThanItCanHoldIsRefusedBeforeTheyAreAllocated) {
    write_exr(path_, gradient(7, 3));
    std::string bytes = read_file(path_);
    for (const std::string window : {"dataWindow", "displayWindow"}) {
        // Behind the name: the type's name "box2i", the size, xMin, yMin, xMax.
        const std::size_t max = bytes.find(window) + window.size() + 1 + 6 + 4 + 8;
        bytes.replace(max, 4, std::string("\xFF\xFF\x7F\0", 4));
    }
    std::ofstream(path_, std::ios::binary) << bytes;
    EXPECT_THAT([&] { read_exr(path_); }, testing::ThrowsMessage<Error>(testing::HasSubstr(
                                              "the file is too short for 8388608 x 3 pixels")));
}

TEST_F(ImageFile, ThatIsCutShortIsAnErrorThatNamesIt) {
    write_exr(path_, gradient(64, 64));
    const std::string bytes = read_file(path_);
    write_file_durably(path_, bytes.substr(0, bytes.size() / 2));
    EXPECT_THAT([this] { read_exr(path_); },
                testing::ThrowsMessage<Error>(testing::HasSubstr(path_.string())));
    EXPECT_THROW(read_exr("no-such.exr"), Error);
}

// In a process of its own, whose files may have 300 bytes: 7 for the right error and no file.
[[noreturn]] void write_with_little_room(const fs::path& path) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{.rlim_cur = 300, .rlim_max = 300};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    try {
        write_exr(path, gradient(8, 4));
    } catch (const Error& e) {
        std::exit(e.code() == Errc::DataLoss && !fs::exists(path) ? 7 : 1);
    }
    std::exit(0);
}

TEST_F(ImageFile, ThatDoesNotFitOnTheDiskIsAnError) {
    EXPECT_EXIT(write_with_little_room(path_), testing::ExitedWithCode(7), "");
}

TEST(Png, IsAPngOfTheRightSize) {
    const std::string png = encode_png(gradient(5, 2), 0);
    EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
    EXPECT_EQ(png.substr(16, 8), std::string("\0\0\0\5\0\0\0\2", 8));
}

TEST(Png, DependsOnTheExposure) {
    const Image image = gradient(8, 8);
    EXPECT_NE(encode_png(image, 0), encode_png(image, 1));
}

}  // namespace
}  // namespace misbench
