// Luminance of linear light with the primaries of Rec. 709.
#pragma once

#include <cstddef>
#include <vector>

#include "renderer/image/image.h"

namespace misbench {

// One value a pixel, row by row.
inline std::vector<double> luminances(const Image& image) {
    std::vector<double> values(image.n_pixels());
    for (std::size_t p = 0; p < values.size(); ++p) {
        const float* rgb = &image.rgb[3 * p];
        values[p] = 0.2126 * static_cast<double>(rgb[0]) + 0.7152 * static_cast<double>(rgb[1]) +
                    0.0722 * static_cast<double>(rgb[2]);
    }
    return values;
}

}  // namespace misbench
