#include "renderer/scene/mitsuba/spectrum.h"

#include <charconv>
#include <cmath>
#include <functional>
#include <sstream>

namespace misbench::mitsuba {
namespace {

constexpr double kFirstWavelength = 360, kLastWavelength = 830;  // nm

struct Xyz {
    double x = 0, y = 0, z = 0;
};

// The CIE 1931 colour matching functions.                               [WSS13, multi-lobe fit]
Xyz matching(double nm) {
    const auto lobe = [nm](double height, double center, double below, double above) {
        const double t = (nm - center) / (nm < center ? below : above);
        return height * std::exp(-0.5 * t * t);
    };
    return {lobe(1.056, 599.8, 37.9, 31.0) + lobe(0.362, 442.0, 16.0, 26.7) +
                lobe(-0.065, 501.1, 20.4, 26.2),
            lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1),
            lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8)};
}

// Linear sRGB; what lies outside of its gamut is cut off.
Rgb to_srgb(const Xyz& c) {
    const auto channel = [&c](double x, double y, double z) {
        return static_cast<float>(std::max(0.0, x * c.x + y * c.y + z * c.z));
    };
    return {channel(3.240479, -1.537150, -0.498535), channel(-0.969256, 1.875991, 0.041556),
            channel(0.055648, -0.204043, 1.057311)};
}

// Of light with that radiance per nm; a spectrum of 1 everywhere has luminance 1.
Rgb emission_of(const std::function<double(double)>& radiance_at) {
    Xyz sum;
    double norm = 0;
    for (double nm = kFirstWavelength; nm <= kLastWavelength; nm += 1) {
        const Xyz m = matching(nm);
        const double radiance = radiance_at(nm);
        sum.x += radiance * m.x, sum.y += radiance * m.y, sum.z += radiance * m.z;
        norm += m.y;
    }
    return to_srgb({sum.x / norm, sum.y / norm, sum.z / norm});
}

// Planck's law, W / (m² sr nm).
double blackbody(double nm, double kelvin) {
    constexpr double kC1 = 2 * 6.62607015e-34 * 299792458.0 * 299792458.0;  // 2 h c²
    constexpr double kC2 = 6.62607015e-34 * 299792458.0 / 1.380649e-23;     // h c / k
    const double meters = nm * 1e-9;
    return kC1 / std::pow(meters, 5) / std::expm1(kC2 / (meters * kelvin)) * 1e-9;
}

std::string text_of(Rgb color) {
    std::ostringstream text;
    text << color.r << ' ' << color.g << ' ' << color.b;
    return text.str();
}

Rgb blackbody_color(Context& context, double kelvin, double scale, const Property& at) {
    if (!(kelvin > 0)) at.fail("the temperature must be above 0");
    const Rgb color = emission_of([&](double nm) { return scale * blackbody(nm, kelvin); });
    std::ostringstream temperature;
    temperature << kelvin;
    context.note("blackbody of " + temperature.str() + " K read as rgb " + text_of(color));
    return color;
}

float srgb_to_linear(double v) {
    return static_cast<float>(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
}

Rgb srgb(const Property& property) {
    const std::string& text = property.attribute("value");
    std::vector<double> v;
    if (text.starts_with('#')) {
        for (std::size_t i = 1; i + 2 <= text.size() && text.size() == 7; i += 2) {
            int byte = 0;
            const char* end = text.data() + i + 2;
            if (std::from_chars(text.data() + i, end, byte, 16).ptr == end)
                v.push_back(byte / 255.0);
        }
        if (v.size() != 3) property.fail("'" + text + "' is not a colour #rrggbb");
    } else {
        v = property.numbers();
    }
    if (v.size() != 1 && v.size() != 3) property.fail("expected one or three numbers");
    return {srgb_to_linear(v[0]), srgb_to_linear(v[1 % v.size()]), srgb_to_linear(v[2 % v.size()])};
}

Rgb uniform(Context& context, double value, ColorRole role) {
    // Version 0.6, compiled for RGB, had one value for all channels.
    if (role != ColorRole::Emission || context.is_old) {
        const auto grey = static_cast<float>(value);
        return {grey, grey, grey};
    }
    const Rgb color = to_srgb({value, value, value});
    context.note("uniform emission spectrum read as rgb " + text_of(color));
    return color;
}

// "400:0.1, 500:0.4": linear between the wavelengths, 0 outside.
Rgb by_wavelength(Context& context, const Property& property, ColorRole role) {
    if (role != ColorRole::Emission) {
        property.fail("a spectrum by wavelength is supported for emission only; give an rgb");
    }
    std::string text = property.attribute("value");
    std::replace(text.begin(), text.end(), ':', ' ');
    Property list = property;
    list.attributes["value"] = text;
    const std::vector<double> v = list.numbers();
    if (v.size() % 2 != 0) property.fail("expected pairs wavelength:value");
    for (std::size_t i = 2; i < v.size(); i += 2) {
        if (!(v[i] > v[i - 2])) property.fail("the wavelengths must grow");
    }
    const Rgb color = emission_of([&v](double nm) {
        for (std::size_t i = 2; i < v.size(); i += 2) {
            if (nm < v[i - 2] || nm > v[i]) continue;
            const double t = (nm - v[i - 2]) / (v[i] - v[i - 2]);
            return (1 - t) * v[i - 1] + t * v[i + 1];
        }
        return 0.0;
    });
    context.note("emission spectrum by wavelength read as rgb " + text_of(color));
    return color;
}

Rgb spectrum(Context& context, const Property& property, ColorRole role) {
    if (property.attribute("value").find(':') != std::string::npos) {
        return by_wavelength(context, property, role);
    }
    const std::vector<double> v = property.numbers();
    if (v.size() == 1) return uniform(context, v[0], role);
    if (v.size() == 3 && context.is_old) {
        return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
    }
    property.fail("expected one number or pairs wavelength:value");
}

Rgb color_of(Context& context, const Property& property, ColorRole role) {
    if (property.type == "rgb" || property.type == "float" || property.type == "integer") {
        const Vec3 v = property.vec3(0);
        return {v.x, v.y, v.z};
    }
    if (property.type == "srgb") return srgb(property);
    if (property.type == "spectrum") return spectrum(context, property, role);
    if (property.type == "blackbody" && role == ColorRole::Emission) {
        Property temperature = property;
        std::string& text = temperature.attributes["temperature"];
        if (text.ends_with('K') || text.ends_with('k')) text.pop_back();
        const double scale = property.has("scale") ? property.number("scale") : 1;
        return blackbody_color(context, temperature.number("temperature"), scale, property);
    }
    property.fail("expected a colour, found a " + property.type);
}

// Version 3 writes some spectra as objects.
Rgb color_of(Context& context, Object& object, const std::string& name, ColorRole role) {
    if (object.tag == "texture") {
        object.place.fail("a texture cannot stand for '" + name + "'");
    }
    const bool emits = role == ColorRole::Emission;
    if (object.tag != "spectrum" || object.type != "blackbody" || !emits) {
        object.refuse_type(emits ? "blackbody" : "none");
    }
    const Property* temperature = object.find("temperature");
    if (temperature == nullptr) object.fail("missing 'temperature'");
    const double scale = double{object.number("scale", 1)};
    object.ignore({"wavelength_min", "wavelength_max"});
    object.expect_all_read();
    return blackbody_color(context, temperature->number(), scale, *temperature);
}

}  // namespace

Rgb read_color(Context& context, Object& object, const std::string& name, ColorRole role,
               std::optional<Rgb> fallback) {
    if (Object* child = object.child(name)) return color_of(context, *child, name, role);
    const Property* property = object.find(name);
    if (property == nullptr) {
        if (!fallback) object.fail("missing '" + name + "'");
        return *fallback;
    }
    const Rgb color = color_of(context, *property, role);
    const float most = role == ColorRole::Reflectance ? 1.0F : std::numeric_limits<float>::max();
    for (const float channel : {color.r, color.g, color.b}) {
        if (!(channel >= 0 && channel <= most)) {
            property->fail(role == ColorRole::Reflectance ? "must be between 0 and 1"
                                                          : "must not be negative");
        }
    }
    return color;
}

}  // namespace misbench::mitsuba
