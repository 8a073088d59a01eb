// Colours and spectra of a scene file as linear RGB.
//
// [WSS13]  C. Wyman, P.-P. Sloan, P. Shirley, Simple analytic approximations to the CIE XYZ color
//          matching functions, 2013.
#pragma once

#include <optional>

#include "renderer/scene/mitsuba/context.h"
#include "renderer/scene/mitsuba/object.h"

namespace misbench::mitsuba {

// What a colour is for: a uniform spectrum reflects as grey, but shines as the white of equal
// energy, which is reddish in sRGB.
enum class ColorRole {
    Reflectance,  // each channel in [0, 1]
    Emission,     // each channel >= 0
    Index,        // a refractive index or extinction: each channel >= 0
};

// The parameter of that name. Throws where it is absent and there is no fallback.
Rgb read_color(Context& context, Object& object, const std::string& name, ColorRole role,
               std::optional<Rgb> fallback = {});

}  // namespace misbench::mitsuba
