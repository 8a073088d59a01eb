#include "renderer/scene/mitsuba/indices.h"

#include <array>

#include "renderer/base/error.h"
#include "renderer/base/names.h"
#include "renderer/scene/conductor_presets.h"
#include "renderer/scene/mitsuba/spectrum.h"

namespace misbench::mitsuba {
namespace {

struct NamedIor {
    const char* name;
    float ior;
};
// Both versions of Mitsuba know these.
constexpr std::array kIors{
    NamedIor{"vacuum", 1.0F},
    NamedIor{"helium", 1.000036F},
    NamedIor{"hydrogen", 1.000132F},
    NamedIor{"air", 1.000277F},
    NamedIor{"carbon dioxide", 1.00045F},
    NamedIor{"water", 1.3330F},
    NamedIor{"acetone", 1.36F},
    NamedIor{"ethanol", 1.361F},
    NamedIor{"carbon tetrachloride", 1.461F},
    NamedIor{"glycerol", 1.4729F},
    NamedIor{"benzene", 1.501F},
    NamedIor{"silicone oil", 1.52045F},
    NamedIor{"bromine", 1.661F},
    NamedIor{"water ice", 1.31F},
    NamedIor{"fused quartz", 1.458F},
    NamedIor{"pyrex", 1.470F},
    NamedIor{"acrylic glass", 1.49F},
    NamedIor{"polypropylene", 1.49F},
    NamedIor{"bk7", 1.5046F},
    NamedIor{"sodium chloride", 1.544F},
    NamedIor{"amber", 1.55F},
    NamedIor{"pet", 1.575F},
    NamedIor{"diamond", 2.419F},
};

// A metal by name.
ComplexIndex preset(const Object& object, const std::string& name) {
    try {
        const ConductorPreset& metal = find_conductor_preset(name);
        return {metal.eta, metal.k};
    } catch (const ParameterError& e) {
        object.fail(e.what());
    }
}

}  // namespace

float read_ior(Object& object, const std::string& name, const std::string& fallback) {
    const Property* property = object.find(name);
    if (property != nullptr && property->type != "string") return object.positive(name, 1);
    const std::string material = object.text(name, fallback);
    try {
        return find_named(kIors, material, name, "material").ior;
    } catch (const ParameterError& e) {
        property->fail(e.what());
    }
}

ComplexIndex read_complex_index(Context& context, Object& object) {
    const bool has_index = object.has("eta") || object.has("k");
    if (object.has("material") && has_index) object.fail("has both 'material' and 'eta' or 'k'");
    const std::string name = object.text("material", context.is_old && !has_index ? "Cu" : "none");
    ComplexIndex index{read_color(context, object, "eta", ColorRole::Index, Rgb{}),
                       read_color(context, object, "k", ColorRole::Index, kWhite)};
    if (name != "none") index = preset(object, name);
    // Version 3 knows no metals in glass.
    if (context.is_old) {
        const float outside = read_ior(object, "ext_eta", "air");
        index.eta = (1 / outside) * index.eta;
        index.k = (1 / outside) * index.k;
    }
    return index;
}

}  // namespace misbench::mitsuba
