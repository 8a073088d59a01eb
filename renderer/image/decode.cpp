#include "renderer/image/decode.h"

#include <stdexcept>

#include "renderer/base/error.h"

namespace misbench {

void check_image_size(std::int64_t width, std::int64_t height) {
    if (width > 0 && height > 0 && width <= kMaxImagePixels / height) return;
    throw std::runtime_error("it has " + std::to_string(width) + " x " + std::to_string(height) +
                             " pixels; at least 1 and at most " + std::to_string(kMaxImagePixels) +
                             " are read");
}

Pixels decode_image(const std::string& bytes, const std::string& name, const std::string& layer) {
    try {
        if (bytes.starts_with("\x76\x2f\x31\x01")) return decode_exr(bytes, layer);
        if (bytes.starts_with("PF") || bytes.starts_with("Pf")) return decode_pfm(bytes);
        return decode_with_stb(bytes);
    } catch (const std::exception& e) {
        throw Error(Errc::InvalidArgument, name + ": " + e.what());
    }
}

}  // namespace misbench
