// Image files as other programs write them: their pixels as they are stored.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace misbench {

// What a file may ask for. More is refused before its pixels are decoded.
inline constexpr std::uintmax_t kMaxImageFileBytes = std::uintmax_t{1} << 30;
inline constexpr std::int64_t kMaxImagePixels = std::int64_t{1} << 27;

struct Pixels {
    int width = 0;
    int height = 0;
    int n_channels = 0;  // 1: grey, 2: grey and alpha, 3: RGB, 4: RGB and alpha
    // Interleaved, row 0 on top, as wide as in the file. Integers are fractions of their largest
    // value, encoded as their writer meant; floats are linear.
    std::variant<std::vector<std::uint8_t>, std::vector<std::uint16_t>, std::vector<float>> values;

    std::size_t n_values() const {
        return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
               static_cast<std::size_t>(n_channels);
    }
};

// PNG, JPEG, TGA, BMP, HDR, PFM or EXR, told apart by the content: names lie. Of an EXR file the
// channels of `layer`, LAYER.R and so on, or where that is empty those without a layer. Throws
// InvalidArgument, "<name>: reason".
Pixels decode_image(const std::string& bytes, const std::string& name,
                    const std::string& layer = "");

// The formats one by one. They throw any std::exception, with the reason alone.
// R, G, B or Y, with or without A; halves become floats. Nothing else is guessed at.
Pixels decode_exr(const std::string& bytes, const std::string& layer = "");
Pixels decode_pfm(const std::string& bytes);
// PNG, JPEG, TGA, BMP, HDR. EXPOSURE lines of HDR files are passed over, as other renderers do.
Pixels decode_with_stb(const std::string& bytes);

// Throws std::runtime_error where an image of this size is empty or beyond the limit.
void check_image_size(std::int64_t width, std::int64_t height);

}  // namespace misbench
