// Textures: a colour or a number for every point of a surface, by its uv coordinates.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <variant>
#include <vector>

#include "renderer/math/vec.h"

namespace misbench {

// The pixels of a texture file, row 0 on top. 8-bit files stay 8 bits a channel and are decoded at
// look-up; files of float stay float.
class TextureImage {
 public:
    // How 8-bit numbers are read: as sRGB, or as they stand. Files of float are always linear.
    enum class Encoding : std::uint8_t { Srgb, Linear };

    // Reads PNG, JPEG, TGA, BMP, HDR, PFM or EXR. 16-bit files become floats. Throws NotFound or
    // InvalidArgument: file, reason; a number that is not finite is one.
    static TextureImage read(const std::filesystem::path& file, Encoding encoding);

    int width() const;
    int height() const;
    bool has_alpha() const;
    std::size_t n_bytes() const;  // in memory
    // REQUIRES: 0 <= x < width(), 0 <= y < height().
    Rgb color(int x, int y) const;
    float alpha(int x, int y) const;  // 1 where the file has none

 private:
    TextureImage() = default;

    std::size_t first_value(int x, int y) const {
        return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                static_cast<std::size_t>(x)) *
               n_channels_;
    }

    int width_ = 0;
    int height_ = 0;
    std::size_t n_channels_ = 0;  // as Pixels::n_channels
    // Interleaved, row 0 on top; one of the two is empty.
    std::vector<std::uint8_t> bytes_;
    std::vector<float> floats_;
    // Where green and blue follow red; both 0 for a grey image.
    std::size_t green_ = 0;
    std::size_t blue_ = 0;
    std::array<float, 256> decoded_{};  // of a colour's byte
};

// An affine map of uv, rows of a 2×3 matrix for column vectors.
using UvTransform = std::array<std::array<float, 3>, 2>;
inline constexpr UvTransform kIdentityUv{{{1, 0, 0}, {0, 1, 0}}};

// An image over the unit square of uv: u to the right, v downwards from the image's top.
struct BitmapTexture {
    enum class Filter : std::uint8_t { Nearest, Bilinear };
    enum class Wrap : std::uint8_t { Repeat, Mirror, Clamp };
    enum class Channel : std::uint8_t { Color, Alpha };  // alpha as a grey

    std::shared_ptr<const TextureImage> image;
    Filter filter = Filter::Nearest;
    Wrap wrap = Wrap::Repeat;
    Channel channel = Channel::Color;
    UvTransform to_uv = kIdentityUv;
    float scale = 1;  // of the looked-up colour
};

// Two colours in squares of side ½ in uv; color0 where both or neither coordinate is in an upper
// half.
struct CheckerboardTexture {
    Rgb color0;
    Rgb color1;
    UvTransform to_uv = kIdentityUv;
};

using Texture = std::variant<BitmapTexture, CheckerboardTexture>;

// Where uv is not finite, as at (0, 0) of the image.
Rgb evaluate(const Texture& texture, Vec2 uv);

}  // namespace misbench
