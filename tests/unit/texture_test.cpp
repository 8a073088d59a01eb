#include "renderer/scene/texture.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <half.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "renderer/base/error.h"
#include "renderer/base/files.h"
#include "renderer/image/decode.h"
#include "renderer/image/image.h"
#include "renderer/image/srgb.h"
#include "renderer/scene/environment.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using Encoding = TextureImage::Encoding;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

std::string from_hex(std::string_view hex) {
    std::string bytes;
    for (std::size_t i = 0; i < hex.size(); i += 2) {
        bytes += static_cast<char>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16));
    }
    return bytes;
}

// (255, 0, 0, 255) (0, 255, 0, 128) / (0, 0, 255, 0) (10, 20, 30, 40).
const std::string kPngWithAlpha = from_hex(
    "89504e470d0a1a0a0000000d4948445200000002000000020806000000"
    "72b60d240000001a4944415478da63f8cfc0f09fe13f43030303c37f062e11390d0036a904e1f47a5adb"
    "0000000049454e44ae426082");
// Grey and alpha: (255, 0) (128, 51) / (3, 255) (0, 4).
const std::string kGreyPngWithAlpha = from_hex(
    "89504e470d0a1a0a0000000d4948445200000002000000020804000000"
    "d8bfc5af000000124944415478da63fecfc068ccc0fc9f8105000d65023d3e0baa4c"
    "0000000049454e44ae426082");
// 16-bit grey: 0 65535 / 256 32768.
const std::string k16BitPng = from_hex(
    "89504e470d0a1a0a0000000d4948445200000002000000021000000000"
    "074d8ebb0000001249444154789c636060f8ff9f9191a19e01000e04028010c7673a"
    "0000000049454e44ae426082");
// 16-bit grey and alpha, one pixel: (32768, 16384).
const std::string k16BitPngWithAlpha = from_hex(
    "89504e470d0a1a0a0000000d4948445200000001000000011004000000e58cd0410000000d49444154789c63"
    "686070600000028500c11ac225240000000049454e44ae426082");
// 16 × 8, the left half (200, 50, 25), the right one (10, 120, 241).
const std::string kJpeg = from_hex(
    "ffd8ffe000104a46494600010100000100010000ffdb00430002010101010102010101020202020204030202"
    "02020504040304060506060605060606070908060709070606080b08090a0a0a0a0a06080b0c0b0a0c090a0a"
    "0affdb004301020202020202050303050a0706070a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a"
    "0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0affc000110800080010030111000211010311"
    "01ffc4001500010100000000000000000000000000000608ffc4001410010000000000000000000000000000"
    "0000ffc40016010101010000000000000000000000000009080affc400141101000000000000000000000000"
    "00000000ffda000c03010002110311003f009bd33934243a8ce3bfffd9");
// 2 × 2, (1, 2, 3) (4, 5, 6) / (7, 8, 9) (10, 11, 12), as TGA from the top, as run-length encoded
// TGA of four packets, and as BMP from the bottom with padded rows.
const std::string kTga = from_hex(
    "000002000000000000000000020002001820"
    "030201060504"
    "0908070c0b0a");
const std::string kPackedTga = from_hex(
    "00000a000000000000000000020002001820"
    "8003020100060504"
    "80090807800c0b0a");
const std::string kBmp = from_hex(
    "424d46000000000000003600000028000000020000000200000001001800000000001000000000000000"
    "000000000000000000000000"
    "0908070c0b0a0000"
    "0302010605040000");
// 2 × 1, (1, 0.5, 0.25) (0, 0, 96).
const std::string kHdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n" + from_hex(
                                                                                   "80402081"
                                                                                   "0000c087");

std::string pfm(const std::string& header, std::vector<float> values, bool big_endian) {
    std::string bytes = header;
    for (const float value : values) {
        std::string raw(sizeof value, '\0');
        std::memcpy(raw.data(), &value, sizeof value);
        if (big_endian) std::reverse(raw.begin(), raw.end());
        bytes += raw;
    }
    return bytes;
}

class TextureFile : public testing::Test {
 protected:
    void SetUp() override { fs::create_directory(folder_); }
    void TearDown() override { fs::remove_all(folder_); }

    fs::path write(const std::string& bytes) const {
        std::ofstream(file_, std::ios::binary) << bytes;
        return file_;
    }
    TextureImage read(const std::string& bytes, Encoding encoding = Encoding::Linear) const {
        return TextureImage::read(write(bytes), encoding);
    }
    fs::path folder_ = fs::temp_directory_path() / ("misbench_texture_" + std::to_string(getpid()));
    fs::path file_ = folder_ / "image";
};

// Of the error that decoding ends with.
std::string complaint(const std::string& bytes) {
    try {
        decode_image(bytes, "texture 'x'");
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), Errc::InvalidArgument);
        EXPECT_THAT(e.what(), testing::StartsWith("texture 'x': "));
        return e.what();
    }
    return "";
}

Rgb bytes_as_color(int r, int g, int b) {
    return {static_cast<float>(r / 255.0), static_cast<float>(g / 255.0),
            static_cast<float>(b / 255.0)};
}

TEST_F(TextureFile, OfBytesIsReadByteByByte) {
    const TextureImage png = read(kPngWithAlpha);
    EXPECT_EQ(png.width(), 2);
    EXPECT_EQ(png.height(), 2);
    EXPECT_TRUE(png.has_alpha());
    EXPECT_EQ(png.color(1, 0), bytes_as_color(0, 255, 0));
    EXPECT_EQ(png.color(1, 1), bytes_as_color(10, 20, 30));
    EXPECT_EQ(png.alpha(1, 0), 128.0F / 255);
    EXPECT_EQ(png.alpha(0, 1), 0);
    EXPECT_LT(png.n_bytes(), sizeof(TextureImage) + 17);

    const TextureImage grey = read(kGreyPngWithAlpha);
    EXPECT_EQ(grey.color(1, 0), bytes_as_color(128, 128, 128));
    EXPECT_EQ(grey.color(0, 1), bytes_as_color(3, 3, 3));
    EXPECT_EQ(grey.alpha(1, 0), 51.0F / 255);

    for (const std::string& bytes : {kTga, kPackedTga, kBmp}) {
        const TextureImage image = read(bytes);
        EXPECT_FALSE(image.has_alpha());
        EXPECT_EQ(image.alpha(0, 0), 1);
        EXPECT_EQ(image.color(0, 0), bytes_as_color(1, 2, 3));
        EXPECT_EQ(image.color(1, 0), bytes_as_color(4, 5, 6));
        EXPECT_EQ(image.color(0, 1), bytes_as_color(7, 8, 9));
        EXPECT_EQ(image.color(1, 1), bytes_as_color(10, 11, 12));
    }
    const TextureImage jpeg = read(kJpeg);
    EXPECT_EQ(jpeg.width(), 16);
    EXPECT_NEAR(255 * jpeg.color(3, 3).r, 200, 1.5);
    EXPECT_NEAR(255 * jpeg.color(3, 3).b, 25, 1.5);
    EXPECT_NEAR(255 * jpeg.color(12, 7).g, 120, 1.5);
}

TEST_F(TextureFile, OfBytesIsDecodedAsItsEncodingSays) {
    Image image(2, 1);
    image.rgb = {0, 1, static_cast<float>(decode_srgb(100 / 255.0)), 1, 0, 0.5F};
    write(encode_png(image, 0));
    const TextureImage linear = TextureImage::read(file_, Encoding::Linear);
    const TextureImage srgb = TextureImage::read(file_, Encoding::Srgb);
    EXPECT_EQ(linear.color(0, 0), bytes_as_color(0, 255, 100));
    EXPECT_EQ(srgb.color(0, 0), (Rgb{0, 1, image.rgb[2]}));
    EXPECT_NEAR(srgb.color(1, 0).b, 0.5, 0.005);
    EXPECT_EQ(read(kPngWithAlpha, Encoding::Srgb).alpha(1, 0), 128.0F / 255);
    // The middle of the range by the standard: 0.21404.
    EXPECT_NEAR(decode_srgb(0.5), 0.2140411, 1e-6);
}

TEST_F(TextureFile, OfSixteenBitsLosesNone) {
    const TextureImage linear = read(k16BitPng);
    EXPECT_EQ(linear.color(1, 0), kWhite);
    EXPECT_EQ(linear.color(0, 1).g, static_cast<float>(256 / 65535.0));
    EXPECT_EQ(linear.color(1, 1).b, static_cast<float>(32768 / 65535.0));
    EXPECT_EQ(read(k16BitPng, Encoding::Srgb).color(1, 1).r,
              static_cast<float>(decode_srgb(32768 / 65535.0)));
    const TextureImage with_alpha = read(k16BitPngWithAlpha, Encoding::Srgb);
    EXPECT_EQ(with_alpha.color(0, 0).g, static_cast<float>(decode_srgb(32768 / 65535.0)));
    EXPECT_EQ(with_alpha.alpha(0, 0), static_cast<float>(16384 / 65535.0));
}

TEST_F(TextureFile, OfFloatsIsLinear) {
    const TextureImage hdr = read(kHdr, Encoding::Srgb);
    EXPECT_EQ(hdr.color(0, 0), (Rgb{1, 0.5F, 0.25F}));
    EXPECT_EQ(hdr.color(1, 0), (Rgb{0, 0, 96}));

    // Rows of PFM files lie from the bottom to the top.
    const std::vector<float> values = {1, 2, 3, 4, 5, 6, -7, 8, 1e-42F, 10, 11, 1e30F};
    for (const bool big_endian : {false, true}) {
        const TextureImage image =
            read(pfm(big_endian ? "PF\n2 2\n1\n" : "PF\n2 2\n-1.0\n", values, big_endian),
                 Encoding::Srgb);
        EXPECT_EQ(image.color(0, 1), (Rgb{1, 2, 3}));
        EXPECT_EQ(image.color(1, 1), (Rgb{4, 5, 6}));
        EXPECT_EQ(image.color(0, 0), (Rgb{-7, 8, 1e-42F}));
        EXPECT_EQ(image.color(1, 0), (Rgb{10, 11, 1e30F}));
    }
    const TextureImage grey = read(pfm("Pf 1 3 -2\n", {1, 2, 3}, false));
    EXPECT_EQ(grey.color(0, 0), (Rgb{6, 6, 6}));
    EXPECT_EQ(grey.color(0, 2), (Rgb{2, 2, 2}));
}

// An EXR file of 3 × 2 pixels whose i-th value of channel c is 10 c + i; `at` is the window's
// corner.
void write_channels(const fs::path& file, const std::vector<const char*>& names,
                    Imf::PixelType type, Imath::V2i at = {0, 0}) {
    const Imath::Box2i window(at, at + Imath::V2i(2, 1));
    Imf::Header header(window, window);
    std::vector<std::array<float, 6>> floats(names.size());
    std::vector<std::array<half, 6>> halves(names.size());
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < names.size(); ++c) {
        for (std::size_t i = 0; i < 6; ++i) {
            floats[c][i] = static_cast<float>(10 * c + i);
            halves[c][i] = floats[c][i];
        }
        header.channels().insert(names[c], Imf::Channel(type));
        const void* values = type == Imf::HALF ? static_cast<void*>(halves[c].data())
                                               : static_cast<void*>(floats[c].data());
        buffer.insert(names[c], Imf::Slice::Make(type, values, window));
    }
    Imf::OutputFile out(file.c_str(), header);
    out.setFrameBuffer(buffer);
    out.writePixels(2);
}

TEST_F(TextureFile, OfExrIsReadByItsChannels) {
    Image image(3, 2);
    for (std::size_t i = 0; i < image.rgb.size(); ++i) image.rgb[i] = static_cast<float>(i);
    write_exr(file_, image);
    EXPECT_EQ(TextureImage::read(file_, Encoding::Srgb).color(1, 1), (Rgb{12, 13, 14}));

    for (const Imf::PixelType type : {Imf::HALF, Imf::FLOAT}) {
        write_channels(file_, {"R", "G", "B", "A", "Z"}, type, {-5, 7});
        const TextureImage color = TextureImage::read(file_, Encoding::Linear);
        EXPECT_EQ(color.width(), 3);
        EXPECT_EQ(color.color(2, 1), (Rgb{5, 15, 25}));
        EXPECT_EQ(color.alpha(1, 0), 31);
        write_channels(file_, {"Y"}, type);
        EXPECT_EQ(TextureImage::read(file_, Encoding::Linear).color(2, 0), (Rgb{2, 2, 2}));
        write_channels(file_, {"Y", "A"}, type);
        EXPECT_EQ(TextureImage::read(file_, Encoding::Linear).alpha(0, 1), 13);
    }
}

TEST_F(TextureFile, OfExrThatIsNotOnePlainImageIsRefused) {
    const auto complaint_of = [this] { return complaint(read_file(file_)); };
    write_channels(file_, {"R", "left.G"}, Imf::HALF);
    EXPECT_THAT(complaint_of(), testing::EndsWith("its channels are R left.G; known: R G B, or Y, "
                                                  "and A; its layers: left"));
    write_channels(file_, {"Y", "RY", "BY"}, Imf::HALF);
    EXPECT_THAT(complaint_of(), testing::HasSubstr("its channels are BY RY Y"));

    Imf::Header cropped(Imath::Box2i({0, 0}, {7, 7}), Imath::Box2i({0, 0}, {3, 3}));
    cropped.channels().insert("Y", Imf::Channel(Imf::HALF));
    Imf::OutputFile(file_.c_str(), cropped);
    EXPECT_THAT(complaint_of(), testing::HasSubstr("data window is not its display window"));

    Imf::Header subsampled(4, 4);
    subsampled.channels().insert("Y", Imf::Channel(Imf::HALF, 2, 2));
    Imf::OutputFile(file_.c_str(), subsampled);
    EXPECT_THAT(complaint_of(), testing::HasSubstr("its channel Y is subsampled"));

    std::vector<Imf::Header> parts(2, Imf::Header(2, 2));
    for (std::size_t i = 0; i < parts.size(); ++i) {
        parts[i].setName(std::to_string(i));
        parts[i].setType(Imf::SCANLINEIMAGE);
        parts[i].channels().insert("Y", Imf::Channel(Imf::FLOAT));
    }
    {
        Imf::MultiPartOutputFile out(file_.c_str(), parts.data(), 2);
        const std::array<float, 4> values{};
        Imf::FrameBuffer buffer;
        buffer.insert("Y",
                      Imf::Slice::Make(Imf::FLOAT, values.data(), cropped.displayWindow(), 4, 8));
        for (int i = 0; i < 2; ++i) {
            Imf::OutputPart part(out, i);
            part.setFrameBuffer(buffer);
            part.writePixels(2);
        }
    }
    EXPECT_THAT(complaint_of(), testing::HasSubstr("it has several parts"));
}

std::vector<std::string> one_of_every_format(const fs::path& scratch) {
    write_channels(scratch, {"R", "G", "B", "A"}, Imf::HALF);
    return {kPngWithAlpha,
            kGreyPngWithAlpha,
            k16BitPng,
            kJpeg,
            kTga,
            kPackedTga,
            kBmp,
            kHdr,
            pfm("Pf 2 1 -1\n", {1, 2}, false),
            read_file(scratch)};
}

TEST_F(TextureFile, ThatIsCutShortIsRefusedAtEveryLength) {
    for (const std::string& bytes : one_of_every_format(file_)) {
        EXPECT_EQ(complaint(bytes), "");
        for (std::size_t n = 0; n < bytes.size(); ++n) {
            EXPECT_NE(complaint(bytes.substr(0, n)), "") << n << " of " << bytes.size();
        }
    }
}

TEST_F(TextureFile, WithAnyByteWrongIsReadOrRefused) {
    for (const std::string& bytes : one_of_every_format(file_)) {
        for (std::size_t i = 0; i < bytes.size(); ++i) {
            for (const int mask : {0x01, 0x80, 0xff}) {
                std::string broken = bytes;
                broken[i] = static_cast<char>(broken[i] ^ mask);
                EXPECT_NO_THROW(complaint(broken)) << "byte " << i;  // but for our own Error
            }
        }
    }
}

TEST_F(TextureFile, WithMoreHuffmanCodesThanBytesIsRefused) {
    // The counts of the codes of the first table begin 5 bytes after its marker.
    std::string bytes = kJpeg;
    const std::size_t table = bytes.find("\xff\xc4");
    bytes[table + 5] = bytes[table + 6] = '\xff';
    EXPECT_THAT(complaint(bytes), testing::ContainsRegex("Huffman table has 51. codes"));
}

TEST_F(TextureFile, BeyondALimitIsRefusedByItsHeader) {
    const std::string limit = "at most " + std::to_string(kMaxImagePixels) + " are read";
    // 16384 × 16384 pixels.
    std::string tga = kTga;
    tga[13] = tga[15] = 0x40;
    tga[12] = tga[14] = 0;
    for (const std::string& bytes :
         {tga, pfm("PF 134217728 2 1\n", {}, false), pfm("PF 0 1 1\n", {}, false),
          std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 20000 +X 20000\n")}) {
        EXPECT_THAT(complaint(bytes), testing::EndsWith(limit));
    }
    Imf::Header header(1 << 14, 1 << 14);
    header.channels().insert("Y", Imf::Channel(Imf::HALF));
    Imf::OutputFile(file_.c_str(), header);
    EXPECT_THAT(complaint(read_file(file_)), testing::EndsWith(limit));

    write(kTga);
    fs::resize_file(file_, kMaxImageFileBytes + 1);
    EXPECT_THAT([this] { TextureImage::read(file_, Encoding::Linear); },
                testing::ThrowsMessage<Error>(testing::HasSubstr("is larger than")));
}

TEST_F(TextureFile, ThatIsNoImageIsNamed) {
    EXPECT_THAT(complaint("GIF89a, not a format of ours"), testing::HasSubstr("not a PNG"));
    EXPECT_THAT(complaint("PF\n1 1\n0\n1234"), testing::HasSubstr("scale"));
    EXPECT_THAT(complaint("PF\nwide 1\n0\n1234"), testing::HasSubstr("header"));
    EXPECT_THAT([this] { read("GIF89a"); }, testing::ThrowsMessage<Error>(testing::StartsWith(
                                                "texture '" + file_.string() + "': not a PNG")));
    EXPECT_THAT(
        [this] {
            read(pfm("PF 2 1 -1\n", {1, 2, 3, 4, kNan, 6}, false));
        },
        testing::ThrowsMessage<Error>(testing::StartsWith("texture '" + file_.string() +
                                                          "': pixel (1, 0) has the value nan")));
    try {
        TextureImage::read(folder_ / "none.png", Encoding::Srgb);
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), Errc::NotFound);
        EXPECT_THAT(e.what(), testing::HasSubstr("none.png"));
    }
}

TEST_F(TextureFile, AsARadianceMapMustNotBeNegative) {
    const Image map = read_radiance_map(write(kHdr));
    EXPECT_EQ(map.width, 2);
    EXPECT_EQ(map.rgb, (std::vector<float>{1, 0.5F, 0.25F, 0, 0, 96}));
    const auto srgb = static_cast<float>(decode_srgb(2 / 255.0));
    EXPECT_EQ(read_radiance_map(write(kBmp)).rgb[1], srgb);
    const auto read_values = [this](float value) {
        read_radiance_map(write(pfm("Pf 2 2 -1\n", {0, 0, 0, value}, false)));
    };
    read_values(0);
    EXPECT_THAT([&] { read_values(-0.5F); }, testing::ThrowsMessage<Error>(testing::HasSubstr(
                                                 "pixel (1, 0) has the negative value -0.5")));
    EXPECT_THAT([&] { read_values(kInfinity); },
                testing::ThrowsMessage<Error>(testing::HasSubstr("pixel (1, 0)")));
}

// A bitmap of 2 × 2: red 1 2 / 3 4, alpha a tenth of it.
class Bitmap : public TextureFile {
 protected:
    void SetUp() override {
        TextureFile::SetUp();
        Imf::Header header(2, 2);
        const std::array<float, 4> red = {1, 2, 3, 4};
        const std::array<float, 4> alpha = {0.1F, 0.2F, 0.3F, 0.4F};
        Imf::FrameBuffer buffer;
        for (const char* name : {"R", "G", "B", "A"}) {
            header.channels().insert(name, Imf::Channel(Imf::FLOAT));
            buffer.insert(name,
                          Imf::Slice::Make(Imf::FLOAT, *name == 'A' ? alpha.data() : red.data(),
                                           header.dataWindow()));
        }
        {
            Imf::OutputFile out(file_.c_str(), header);
            out.setFrameBuffer(buffer);
            out.writePixels(2);
        }
        bitmap_.image = std::make_shared<const TextureImage>(
            TextureImage::read(file_, TextureImage::Encoding::Linear));
    }

    float red(float u, float v) const { return evaluate(bitmap_, {u, v}).r; }

    BitmapTexture bitmap_{.image = nullptr};
};

using Wrap = BitmapTexture::Wrap;
using Filter = BitmapTexture::Filter;

TEST_F(Bitmap, StartsAtTheTopLeft) {
    EXPECT_EQ(red(0, 0), 1);
    EXPECT_EQ(red(0.75F, 0.25F), 2);
    EXPECT_EQ(red(0.25F, 0.75F), 3);
    EXPECT_EQ(red(0.5F, 0.5F), 4);
}

TEST_F(Bitmap, GoesOnAsItsWrapSays) {
    // Along u in the upper row, a texel each: from -2 to 2.
    const std::map<Wrap, std::array<float, 8>> expected = {
        {Wrap::Repeat, {1, 2, 1, 2, 1, 2, 1, 2}},
        {Wrap::Mirror, {1, 2, 2, 1, 1, 2, 2, 1}},
        {Wrap::Clamp, {1, 1, 1, 1, 1, 2, 2, 2}},
    };
    for (const auto& [wrap, values] : expected) {
        bitmap_.wrap = wrap;
        for (std::size_t i = 0; i < values.size(); ++i) {
            const float u = 0.5F * static_cast<float>(i) - 2;
            for (const float inside : {0.0F, 0.1F, 0.4F}) {
                EXPECT_EQ(red(u + inside, 0.25F), values[i]) << u;
                // Down the left column: 3 in place of 2.
                EXPECT_EQ(red(0.25F, u + inside), values[i] == 2 ? 3 : 1) << u;
            }
        }
    }
}

TEST_F(Bitmap, IsLinearBetweenTexelCentres) {
    bitmap_.filter = Filter::Bilinear;
    for (const Wrap wrap : {Wrap::Repeat, Wrap::Mirror, Wrap::Clamp}) {
        bitmap_.wrap = wrap;
        EXPECT_EQ(red(0.25F, 0.25F), 1);
        EXPECT_EQ(red(0.75F, 0.75F), 4);
        EXPECT_EQ(red(0.5F, 0.25F), 1.5F);
        EXPECT_EQ(red(0.375F, 0.5F), 2.25F);
        // A quarter of a texel beyond the last centre, halfway to the border.
        EXPECT_EQ(red(0.875F, 0.25F), wrap == Wrap::Repeat ? 1.75F : 2);
        EXPECT_EQ(red(1, 0.25F), wrap == Wrap::Repeat ? 1.5F : 2);
        EXPECT_EQ(red(0.25F, 0), wrap == Wrap::Repeat ? 2 : 1);
        EXPECT_EQ(red(1.25F, 0.25F), wrap == Wrap::Repeat ? 1 : 2);
    }
}

TEST_F(Bitmap, IsScaledAndMovedAndGivesItsAlpha) {
    bitmap_.scale = 3;
    bitmap_.to_uv = {{{0, 1, 0.5F}, {2, 0, 0}}};
    EXPECT_EQ(red(0.3F, 0.1F), 3 * 4);  // looked up at (0.6, 0.6)
    bitmap_.channel = BitmapTexture::Channel::Alpha;
    EXPECT_EQ(evaluate(bitmap_, {0.3F, 0.1F}), 3 * 0.4F * kWhite);
}

TEST_F(Bitmap, TakesAnyUv) {
    for (const Wrap wrap : {Wrap::Repeat, Wrap::Mirror, Wrap::Clamp}) {
        bitmap_.wrap = wrap;
        for (const Filter filter : {Filter::Nearest, Filter::Bilinear}) {
            bitmap_.filter = filter;
            for (const float u :
                 {-0.0F, -1e-45F, -1e-8F, 1 - 0x1p-24F, 1e9F, -1e9F, 1e20F, -1e20F,
                  std::numeric_limits<float>::max(), std::numeric_limits<float>::lowest()}) {
                EXPECT_GE(red(u, 0.25F), 1) << u;
                EXPECT_LE(red(u, 0.25F), 2) << u;
                EXPECT_GE(red(0.25F, u), 1) << u;
                EXPECT_LE(red(0.25F, u), 3) << u;
            }
            for (const float u : {kNan, kInfinity, -kInfinity}) {
                EXPECT_EQ(red(u, 0.75F), red(0, 0));
                EXPECT_EQ(red(0.75F, u), red(0, 0));
            }
        }
    }
}

// Computed by Mitsuba 3.9.1 from the same uv: whether it is color1.
struct Square {
    Vec2 uv;
    bool is_color1;
};

TEST(Checkerboard, IsThatOfMitsuba) {
    const CheckerboardTexture plain{.color0 = {1, 0, 0}, .color1 = {0, 0, 1}};
    for (const Square& square : std::initializer_list<Square>{{{0, 0}, false},
                                                              {{0.5F, 0}, false},
                                                              {{0.25F, 0.75F}, true},
                                                              {{0.75F, 0.75F}, false},
                                                              {{-0.25F, 0.25F}, true},
                                                              {{1, 0.5F}, false},
                                                              {{-0.5F, 0.75F}, true},
                                                              {{0.50001F, 0.25F}, true},
                                                              {{-1.572F, 0.265F}, false},
                                                              {{0.754F, -2.607F}, true},
                                                              {{2.974F, -0.178F}, false},
                                                              {{1.028F, -2.616F}, false}}) {
        EXPECT_EQ(evaluate(plain, square.uv), square.is_color1 ? plain.color1 : plain.color0)
            << square.uv.x << ' ' << square.uv.y;
    }
    CheckerboardTexture moved = plain;
    moved.to_uv = {{{3, 0.5F, 0.25F}, {-1, 2, -0.75F}}};
    for (const Square& square : std::initializer_list<Square>{{{0, 0}, false},
                                                              {{0.5F, 0}, false},
                                                              {{0.25F, 0.75F}, false},
                                                              {{0.75F, 0.75F}, true},
                                                              {{-0.25F, 0.25F}, true},
                                                              {{1, 0.5F}, false},
                                                              {{-0.5F, 0.75F}, false},
                                                              {{0.50001F, 0.25F}, true},
                                                              {{1.285F, 2.527F}, false},
                                                              {{2.273F, -2.415F}, true},
                                                              {{2.793F, -0.383F}, true},
                                                              {{2.138F, 2.946F}, false}}) {
        EXPECT_EQ(evaluate(moved, square.uv), square.is_color1 ? plain.color1 : plain.color0)
            << square.uv.x << ' ' << square.uv.y;
    }
    EXPECT_EQ(evaluate(plain, {kNan, 0.25F}), plain.color0);
    EXPECT_EQ(evaluate(plain, {0.25F, kInfinity}), plain.color0);
}

}  // namespace
}  // namespace misbench
