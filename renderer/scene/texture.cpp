#include "renderer/scene/texture.h"

#include <algorithm>
#include <cmath>

#include "renderer/base/error.h"
#include "renderer/base/files.h"
#include "renderer/image/decode.h"
#include "renderer/image/srgb.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;

// 16-bit numbers as floats: alpha is linear in every encoding.
std::vector<float> to_floats(const std::vector<std::uint16_t>& values, std::size_t n_channels,
                             TextureImage::Encoding encoding) {
    const bool has_alpha = n_channels % 2 == 0;
    std::vector<float> floats(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        const bool is_alpha = has_alpha && i % n_channels == n_channels - 1;
        const double value = values[i] / 65535.0;
        const bool is_srgb = encoding == TextureImage::Encoding::Srgb && !is_alpha;
        floats[i] = static_cast<float>(is_srgb ? decode_srgb(value) : value);
    }
    return floats;
}

// The texel that a whole number of texels from the origin names. Exact up to 2⁵³; beyond, where
// neighbouring numbers of texels can no longer be told apart, some texel of the image.
int wrapped(double texel, int size, BitmapTexture::Wrap wrap) {
    const double n = size;
    switch (wrap) {
        case BitmapTexture::Wrap::Repeat:
            texel -= n * std::floor(texel / n);
            break;
        case BitmapTexture::Wrap::Mirror:
            texel -= 2 * n * std::floor(texel / (2 * n));
            if (texel >= n) texel = 2 * n - 1 - texel;
            break;
        case BitmapTexture::Wrap::Clamp:
            break;
    }
    return static_cast<int>(std::clamp(texel, 0.0, n - 1));
}

Vec2 transformed(const UvTransform& m, Vec2 uv) {
    return {m[0][0] * uv.x + m[0][1] * uv.y + m[0][2], m[1][0] * uv.x + m[1][1] * uv.y + m[1][2]};
}

Rgb texel(const BitmapTexture& texture, int x, int y) {
    if (texture.channel == BitmapTexture::Channel::Color) return texture.image->color(x, y);
    return texture.image->alpha(x, y) * kWhite;
}

Rgb looked_up(const BitmapTexture& texture, Vec2 uv) {
    const int width = texture.image->width();
    const int height = texture.image->height();
    const double x = double{uv.x} * width;
    const double y = double{uv.y} * height;
    const auto column = [&](double i) { return wrapped(i, width, texture.wrap); };
    const auto row = [&](double i) { return wrapped(i, height, texture.wrap); };
    if (texture.filter == BitmapTexture::Filter::Nearest) {
        return texel(texture, column(std::floor(x)), row(std::floor(y)));
    }
    // Texel centres lie at halves.
    const double left = std::floor(x - 0.5);
    const double top = std::floor(y - 0.5);
    const auto s = static_cast<float>(x - 0.5 - left);
    const auto t = static_cast<float>(y - 0.5 - top);
    const int x0 = column(left);
    const int x1 = column(left + 1);
    const int y0 = row(top);
    const int y1 = row(top + 1);
    return lerp(t, lerp(s, texel(texture, x0, y0), texel(texture, x1, y0)),
                lerp(s, texel(texture, x0, y1), texel(texture, x1, y1)));
}

Rgb evaluate_one(const BitmapTexture& texture, Vec2 uv) {
    uv = transformed(texture.to_uv, uv);
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) uv = {};
    return texture.scale * looked_up(texture, uv);
}

Rgb evaluate_one(const CheckerboardTexture& texture, Vec2 uv) {
    uv = transformed(texture.to_uv, uv);
    // False of what is not finite, as of 0.
    const auto is_upper = [](float u) { return u - std::floor(u) > 0.5F; };
    return is_upper(uv.x) == is_upper(uv.y) ? texture.color0 : texture.color1;
}

}  // namespace

TextureImage TextureImage::read(const fs::path& file, Encoding encoding) {
    const std::string name = "texture '" + file.string() + "'";
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) {
        throw Error(Errc::NotFound, name + ": no such file");
    }
    if (fs::file_size(file) > kMaxImageFileBytes) {
        throw Error(Errc::InvalidArgument,
                    name + ": it is larger than " + std::to_string(kMaxImageFileBytes) + " bytes");
    }
    Pixels pixels = decode_image(read_file(file), name);

    TextureImage image;
    image.width_ = pixels.width;
    image.height_ = pixels.height;
    image.n_channels_ = static_cast<std::size_t>(pixels.n_channels);
    const bool is_grey = image.n_channels_ < 3;
    image.green_ = is_grey ? 0 : 1;
    image.blue_ = is_grey ? 0 : 2;
    for (std::size_t i = 0; i < image.decoded_.size(); ++i) {
        const double value = static_cast<double>(i) / 255;
        image.decoded_[i] =
            static_cast<float>(encoding == Encoding::Srgb ? decode_srgb(value) : value);
    }
    if (auto* bytes = std::get_if<std::vector<std::uint8_t>>(&pixels.values)) {
        image.bytes_ = std::move(*bytes);
        return image;
    }
    const auto* words = std::get_if<std::vector<std::uint16_t>>(&pixels.values);
    image.floats_ = words != nullptr ? to_floats(*words, image.n_channels_, encoding)
                                     : std::get<std::vector<float>>(std::move(pixels.values));
    const auto broken = std::find_if(image.floats_.begin(), image.floats_.end(),
                                     [](float value) { return !std::isfinite(value); });
    if (broken != image.floats_.end()) {
        const auto pixel = (broken - image.floats_.begin()) / pixels.n_channels;
        throw Error(Errc::InvalidArgument, name + ": pixel (" +
                                               std::to_string(pixel % pixels.width) + ", " +
                                               std::to_string(pixel / pixels.width) +
                                               ") has the value " + std::to_string(*broken));
    }
    return image;
}

int TextureImage::width() const { return width_; }
int TextureImage::height() const { return height_; }
bool TextureImage::has_alpha() const { return n_channels_ % 2 == 0; }
std::size_t TextureImage::n_bytes() const {
    return sizeof *this + bytes_.size() + floats_.size() * sizeof(float);
}

Rgb TextureImage::color(int x, int y) const {
    const std::size_t i = first_value(x, y);
    if (floats_.empty()) {
        return {decoded_[bytes_[i]], decoded_[bytes_[i + green_]], decoded_[bytes_[i + blue_]]};
    }
    return {floats_[i], floats_[i + green_], floats_[i + blue_]};
}

float TextureImage::alpha(int x, int y) const {
    if (!has_alpha()) return 1;
    const std::size_t i = first_value(x, y) + n_channels_ - 1;
    return floats_.empty() ? static_cast<float>(bytes_[i]) / 255 : floats_[i];
}

Rgb evaluate(const Texture& texture, Vec2 uv) {
    return std::visit([uv](const auto& t) { return evaluate_one(t, uv); }, texture);
}

}  // namespace misbench
