#include "experiments/report/pixel_block.h"

#include <half.h>
#include <zlib.h>

#include <bit>
#include <cmath>
#include <cstdint>

#include "renderer/base/check.h"

namespace misbench {
namespace {

// Halves of this exponent are far from overflow, also when rounded up.
constexpr int kLargestExponent = 14;

// The power of two that brings the largest finite magnitude into [2^14, 2^15).
double scale_of(const Image& image) {
    double largest = 0;
    for (const float value : image.rgb) {
        if (std::isfinite(value)) largest = std::max(largest, std::abs(static_cast<double>(value)));
    }
    return largest == 0 ? 1 : std::exp2(kLargestExponent - std::ilogb(largest));
}

// The bits of every value, plane by plane, each plane byte by byte. The channels of a pixel share
// the noise of its paths: red and blue less green take a fifth less room.
template <typename Bits>
std::string shuffle(const Image& image, const auto& bits_of) {
    const std::size_t n = image.n_pixels();
    std::string bytes(3 * n * sizeof(Bits), '\0');
    for (std::size_t p = 0; p < n; ++p) {
        const Bits green = bits_of(image.rgb[3 * p + 1]);
        for (std::size_t c = 0; c < 3; ++c) {
            auto bits = static_cast<std::uint64_t>(bits_of(image.rgb[3 * p + c]));
            if (c != 1) bits -= green;
            for (std::size_t b = 0; b < sizeof(Bits); ++b) {
                const std::uint64_t byte = bits >> 8U * (sizeof(Bits) - 1 - b) & 0xFFU;
                bytes[(c * sizeof(Bits) + b) * n + p] = static_cast<char>(byte);
            }
        }
    }
    return bytes;
}

// Noise hardly compresses: the most effort takes five times as long and saves 3 %.
constexpr int kEffort = 1;

std::string deflate_raw(const std::string& bytes) {
    z_stream stream{};
    MISBENCH_CHECK(deflateInit2(&stream, kEffort, Z_DEFLATED, -MAX_WBITS, 9, Z_DEFAULT_STRATEGY) ==
                   Z_OK);
    std::string packed(deflateBound(&stream, bytes.size()), '\0');
    // The library only reads from its input; its interface is not const-correct.
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    const int outcome = deflate(&stream, Z_FINISH);
    packed.resize(stream.total_out);
    deflateEnd(&stream);
    MISBENCH_CHECK(outcome == Z_STREAM_END);
    return packed;
}

}  // namespace

std::string to_string(Precision precision) {
    return precision == Precision::Half ? "half" : "float";
}

PixelBlock pack_pixels(const Image& image, Precision precision) {
    if (precision == Precision::Float) {
        const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
        return {.precision = precision,
                .scale = 1,
                .bytes = deflate_raw(shuffle<std::uint32_t>(image, bits))};
    }
    const double scale = scale_of(image);
    const auto bits = [scale](float value) {
        return half(static_cast<float>(scale * static_cast<double>(value))).bits();
    };
    return {.precision = precision,
            .scale = scale,
            .bytes = deflate_raw(shuffle<std::uint16_t>(image, bits))};
}

}  // namespace misbench
