// Pixels as the report keeps them: high dynamic range, small, and decoded by what browsers have.
#pragma once

#include <string>

#include "renderer/image/image.h"

namespace misbench {

// Half: 11 significant bits of every value times a power of two, which brings the image's largest
// finite magnitude into [2^14, 2^15). So nothing overflows, and a rounded value is off by at most
// 2^-11 of itself or, far below the largest, 2^-40 of that one. Float: every bit of the image.
// Both keep infinities, and that a value is not a number.
enum class Precision { Half, Float };
std::string to_string(Precision precision);  // "half", "float"

struct PixelBlock {
    Precision precision = Precision::Half;
    double scale = 1;  // what is stored is the image times this
    // DEFLATE without header (RFC 1951) of three planes, row 0 on top: the bits of R less those of
    // G, of G, and of B less those of G, as unsigned integers that wrap around; of each plane all
    // highest bytes, then all next ones.
    std::string bytes;
};
PixelBlock pack_pixels(const Image& image, Precision precision);

}  // namespace misbench
