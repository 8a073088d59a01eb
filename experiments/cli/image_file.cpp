#include "experiments/cli/image_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <variant>
#include <vector>

#include "renderer/base/error.h"
#include "renderer/base/files.h"
#include "renderer/image/decode.h"
#include "renderer/image/srgb.h"

namespace misbench {
namespace {

template <typename Value>
float linear_of(Value value) {
    if constexpr (std::is_same_v<Value, float>) {
        return value;
    } else {
        const double encoded = static_cast<double>(value) / std::numeric_limits<Value>::max();
        return static_cast<float>(decode_srgb(encoded));
    }
}

Image linear_rgb(const Pixels& pixels) {
    Image image(pixels.width, pixels.height);
    const auto n_channels = static_cast<std::size_t>(pixels.n_channels);
    const bool is_grey = n_channels < 3;
    std::visit(
        [&](const auto& values) {
            for (std::size_t p = 0; p < image.n_pixels(); ++p) {
                for (std::size_t c = 0; c < 3; ++c) {
                    image.rgb[3 * p + c] = linear_of(values[n_channels * p + (is_grey ? 0 : c)]);
                }
            }
        },
        pixels.values);
    return image;
}

void require_finite(const Image& image, const std::string& name) {
    std::size_t n_bad = 0;
    std::size_t first = 0;
    for (std::size_t p = image.n_pixels(); p-- > 0;) {
        const float* rgb = &image.rgb[3 * p];
        if (std::all_of(rgb, rgb + 3, [](float value) { return std::isfinite(value); })) continue;
        ++n_bad;
        first = p;
    }
    if (n_bad == 0) return;
    const auto width = static_cast<std::size_t>(image.width);
    throw Error(
        Errc::InvalidArgument,
        fmt::format("{}: {} of its {} pixels {} not finite, the first at {},{}", name, n_bad,
                    image.n_pixels(), n_bad == 1 ? "is" : "are", first % width, first / width));
}

// Whatever is wrong with a file that a user names is wrong with what the user wrote.
std::string bytes_of(const std::filesystem::path& path) {
    try {
        return read_file(path);
    } catch (const Error& e) {
        throw Error(Errc::InvalidArgument, e.what());
    }
}

}  // namespace

ImageFile read_image_file(const std::filesystem::path& path, const std::string& layer) {
    const std::string name = "image '" + path.string() + "'";
    const Pixels pixels = decode_image(bytes_of(path), name, layer);
    ImageFile file{.image = linear_rgb(pixels), .assumption = {}};
    require_finite(file.image, name);
    const bool is_encoded = !std::holds_alternative<std::vector<float>>(pixels.values);
    const bool has_alpha = pixels.n_channels % 2 == 0;
    if (is_encoded) file.assumption = "taken as sRGB";
    if (has_alpha) file.assumption += is_encoded ? ", alpha left out" : "alpha left out";
    return file;
}

}  // namespace misbench
