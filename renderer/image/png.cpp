#include <png.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "renderer/base/check.h"
#include "renderer/image/image.h"
#include "renderer/image/srgb.h"

namespace misbench {
namespace {

unsigned char srgb_byte(float linear) {
    const float encoded = encode_srgb(std::clamp(linear, 0.0F, 1.0F));
    return static_cast<unsigned char>(std::lround(255.0F * encoded));
}

}  // namespace

std::vector<std::uint8_t> to_srgb_bytes(const Image& image, double exposure) {
    constexpr unsigned char kMagenta[3] = {255, 0, 255};
    const float scale = static_cast<float>(std::exp2(exposure));
    std::vector<std::uint8_t> bytes(image.rgb.size());
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
        const float* rgb = &image.rgb[i];
        const bool finite = std::isfinite(rgb[0]) && std::isfinite(rgb[1]) && std::isfinite(rgb[2]);
        for (std::size_t c = 0; c < 3; ++c) {
            bytes[i + c] = finite ? srgb_byte(scale * rgb[c]) : kMagenta[c];
        }
    }
    return bytes;
}

std::string encode_png(int width, int height, std::span<const std::uint8_t> rgb) {
    MISBENCH_CHECK(rgb.size() ==
                   3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = static_cast<png_uint_32>(width);
    png.height = static_cast<png_uint_32>(height);
    png.format = PNG_FORMAT_RGB;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
    std::string encoded(size, '\0');
    MISBENCH_CHECK(
        png_image_write_to_memory(&png, encoded.data(), &size, 0, rgb.data(), 0, nullptr) != 0);
    encoded.resize(size);
    return encoded;
}

std::string encode_png(const Image& image, double exposure) {
    return encode_png(image.width, image.height, to_srgb_bytes(image, exposure));
}

}  // namespace misbench
