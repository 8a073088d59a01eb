// Pixels of a figure, ready to be shown: 8 bits a channel, sRGB. What turns images and error maps
// into them.
#pragma once

#include <cstdint>
#include <vector>

#include "renderer/image/image.h"

namespace misbench::figure {

struct Raster {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> rgb;  // interleaved, row 0 on top
    bool operator==(const Raster&) const = default;
};

// Pixels of an image, from its upper left corner.
struct Window {
    int x = 0;
    int y = 0;
    int width = 0;
    int height = 0;
    bool operator==(const Window&) const = default;
};

// One value a pixel, row by row.
struct ValueMap {
    int width = 0;
    int height = 0;
    std::vector<double> values;

    double at(int x, int y) const {
        return values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x)];
    }
};

// What the ends of the colour map stand for, and how values between them are spread.
struct ColourScale {
    double low = 0;
    double high = 1;
    bool logarithmic = false;
    // Within [0, 1]; what lies outside is clamped, NaN too, to 0.
    double position(double value) const;
};

// Times 2^exposure, as PNG files of images show it.
Raster to_raster(const Image& image, double exposure);
Raster to_raster(const ValueMap& map, const ColourScale& scale);
// REQUIRES: the window lies within the raster.
Raster cut(const Raster& raster, const Window& window);
// The left half of one, the right half of the other. REQUIRES: both of one size.
Raster split(const Raster& left, const Raster& right);

// REQUIRES: the window lies within the map and is not empty.
double mean_within(const ValueMap& map, const Window& window);

// From the 1st to the 99th percentile of the positive values, to one digit. A linear scale begins
// at 0. It ends at 1 where there are none.
ColourScale scale_of(const std::vector<const ValueMap*>& maps, bool logarithmic);

}  // namespace misbench::figure
