// The transfer functions of sRGB (IEC 61966-2-1), of one channel in [0, 1].
#pragma once

#include <cmath>

namespace misbench {

inline float encode_srgb(float linear) {
    return linear <= 0.0031308F ? 12.92F * linear : 1.055F * std::pow(linear, 1.0F / 2.4F) - 0.055F;
}

inline double decode_srgb(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

}  // namespace misbench
