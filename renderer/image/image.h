// An image: linear RGB, float, row 0 on top.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace misbench {

struct Image {
    int width = 0;
    int height = 0;
    std::vector<float> rgb;  // 3 · width · height, interleaved

    Image() = default;
    Image(int w, int h)
        : width(w),
          height(h),
          rgb(3 * static_cast<std::size_t>(w) * static_cast<std::size_t>(h), 0.0F) {}
    std::size_t n_pixels() const { return rgb.size() / 3; }
    bool operator==(const Image&) const = default;
};

struct NamedImage {
    std::string name;
    Image image;

    bool operator==(const NamedImage&) const = default;
};

// Float RGB, uncompressed (Monte Carlo noise does not compress), with string attributes in the
// header; written whole or not at all. write_exr throws DataLoss, read_exr NotFound or DataLoss,
// both naming the file.
void write_exr(const std::filesystem::path& path, const Image& image,
               const std::map<std::string, std::string>& attributes = {});
Image read_exr(const std::filesystem::path& path);

// One image of several in a file: its channels are NAME.R NAME.G NAME.B, and R G B of the layer
// without a name, which is what programs show that know of no layers.
struct ImageLayer {
    std::string name;
    const Image* image = nullptr;
};
// REQUIRES: at least one layer; different names; all of one size. Compressed without loss; else
// like write_exr, and read_exr gives the layer without a name.
void write_exr_layers(const std::filesystem::path& path, std::span<const ImageLayer> layers,
                      const std::map<std::string, std::string>& attributes = {});

// Layers of these names, of float, in this order (absent: all that have R G B), and all string
// attributes of the file. Throws like read_exr, also when a layer is missing.
struct ExrLayers {
    std::vector<NamedImage> images;
    std::map<std::string, std::string> attributes;
};
ExrLayers read_exr_layers(const std::filesystem::path& path,
                          const std::optional<std::vector<std::string>>& names = std::nullopt);

// The image times 2^exposure, clamped to [0, 1], in 8 bits of sRGB, interleaved; non-finite pixels
// are magenta.
std::vector<std::uint8_t> to_srgb_bytes(const Image& image, double exposure);
// A PNG in memory. REQUIRES: `rgb` has 3 · width · height values.
std::string encode_png(int width, int height, std::span<const std::uint8_t> rgb);
std::string encode_png(const Image& image, double exposure);

}  // namespace misbench
