// Image files of other programs as linear light.
#pragma once

#include <filesystem>
#include <string>

#include "renderer/image/image.h"

namespace misbench {

struct ImageFile {
    Image image;
    std::string assumption;  // what was taken for granted of the file, "" for nothing
};

// EXR, PFM, HDR: linear, as they are. PNG, JPEG, TGA, BMP: sRGB. Grey is the same in all channels,
// alpha is left out. Throws InvalidArgument for what cannot be read, is no image, or has pixels
// that are not finite. `layer` as in decode_image().
ImageFile read_image_file(const std::filesystem::path& path, const std::string& layer = "");

}  // namespace misbench
