// The portable float map: "PF" (RGB) or "Pf" (grey), width, height and scale as text, one white
// space, then rows of floats from the bottom to the top. A negative scale says little-endian; its
// size is a factor.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include "renderer/image/decode.h"

namespace misbench {
namespace {

static_assert(std::endian::native == std::endian::little);

template <class Number>
Number number_at(std::string_view bytes, std::size_t& at) {
    at = std::min(bytes.find_first_not_of(" \t\r\n", at), bytes.size());
    Number value{};
    const auto [end, status] =
        std::from_chars(bytes.data() + at, bytes.data() + bytes.size(), value);
    if (status != std::errc()) {
        throw std::runtime_error("its header is not width, height and scale");
    }
    at = static_cast<std::size_t>(end - bytes.data());
    return value;
}

float float_at(std::string_view bytes, std::size_t at, bool big_endian) {
    std::array<char, sizeof(float)> raw;
    std::memcpy(raw.data(), bytes.data() + at, sizeof(float));
    if (big_endian) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<float>(raw);
}

}  // namespace

Pixels decode_pfm(const std::string& bytes) {
    std::size_t at = 2;
    Pixels pixels;
    pixels.n_channels = bytes[1] == 'F' ? 3 : 1;
    pixels.width = number_at<int>(bytes, at);
    pixels.height = number_at<int>(bytes, at);
    check_image_size(pixels.width, pixels.height);
    const float scale = number_at<float>(bytes, at);
    if (scale == 0 || !std::isfinite(scale))
        throw std::runtime_error("its scale is 0 or no number");
    ++at;
    const std::size_t n = pixels.n_values();
    if (at > bytes.size() || bytes.size() - at != n * sizeof(float)) {
        throw std::runtime_error("it has " + std::to_string(bytes.size()) + " bytes, not " +
                                 std::to_string(at + n * sizeof(float)) + " as its header says");
    }
    std::vector<float> values(n);
    const std::size_t n_row = n / static_cast<std::size_t>(pixels.height);
    for (std::size_t i = 0; i < n; ++i) {
        // Row r of the file, from the bottom, is row height - 1 - r of the image.
        const std::size_t target = n - n_row - i / n_row * n_row + i % n_row;
        values[target] = std::abs(scale) * float_at(bytes, at + i * sizeof(float), scale > 0);
    }
    pixels.values = std::move(values);
    return pixels;
}

}  // namespace misbench
