#include "renderer/scene/mitsuba/bsdfs.h"

#include <array>
#include <type_traits>

#include "renderer/scene/mitsuba/indices.h"
#include "renderer/scene/mitsuba/spectrum.h"

namespace misbench::mitsuba {
namespace {

constexpr std::string_view kKnown =
    "diffuse roughdiffuse conductor roughconductor dielectric roughdielectric thindielectric "
    "plastic roughplastic twosided mask blendbsdf null";

Microfacets read_distribution(Object& object) {
    object.ignore({"sample_visible"});  // how Mitsuba samples: the same material
    const std::string name = object.text("distribution", "beckmann");
    if (name == "beckmann") return Microfacets::Beckmann;
    if (name == "ggx") return Microfacets::Ggx;
    object.fail("distribution '" + name + "' is not supported; known: beckmann ggx");
}

float read_alpha(Object& object) {
    float alpha = object.number("alpha", 0.1F);
    if (object.has("alpha_u") || object.has("alpha_v")) {
        if (object.has("alpha")) object.fail("has both 'alpha' and 'alpha_u' or 'alpha_v'");
        alpha = object.number("alpha_u", 0.1F);
        if (object.number("alpha_v", 0.1F) != alpha) {
            object.fail("anisotropic roughness is not supported: 'alpha_u' is not 'alpha_v'");
        }
    }
    if (!(alpha >= 1e-4F && alpha <= 1)) object.fail("'alpha' must be between 1e-4 and 1");
    return alpha;
}

// Inside over outside.
float read_eta(Object& object, const std::string& inside, float above) {
    const float eta = read_ior(object, "int_ior", inside) / read_ior(object, "ext_ior", "air");
    if (!(eta > above)) object.fail("'int_ior' must be above 'ext_ior'");
    return eta;
}

Rgb read_reflectance(Context& context, Object& object, const std::string& name) {
    return read_color(context, object, name, ColorRole::Reflectance, kWhite);
}

// What the readers below need, and where they put the texture that stands for the colour.
struct Reader {
    Context& context;
    Textures& textures;
    Object& object;
    std::int32_t color_texture = kNoTexture;

    void color(const char* name, Rgb& value) {
        color_texture = textures.read_color_or_texture(object, name, value);
    }
};

Material read_diffuse(Reader& r) {
    DiffuseMaterial material{.reflectance = {0.5F, 0.5F, 0.5F}};
    r.color("reflectance", material.reflectance);
    return material;
}

Material read_rough_diffuse(Reader& r) {
    RoughDiffuseMaterial::Parameters p;
    r.color("reflectance", p.reflectance);
    p.alpha = r.object.number("alpha", p.alpha);
    if (!(p.alpha >= 0)) r.object.fail("'alpha' must not be negative");
    if (r.object.boolean("use_fast_approx", false)) {
        r.object.fail("'use_fast_approx' is not supported: only the full model is");
    }
    return RoughDiffuseMaterial(p);
}

template <class Conductor>
Material read_conductor(Reader& r) {
    typename Conductor::Parameters p;
    const ComplexIndex index = read_complex_index(r.context, r.object);
    p.eta = index.eta;
    p.k = index.k;
    r.color("specular_reflectance", p.specular_reflectance);
    if constexpr (std::is_same_v<Conductor, RoughConductorMaterial>) {
        p.distribution = read_distribution(r.object);
        p.alpha = read_alpha(r.object);
    }
    return Conductor(p);
}

template <class Dielectric>
Material read_dielectric(Reader& r) {
    typename Dielectric::Parameters p;
    p.eta = read_eta(r.object, "bk7", 0);
    p.specular_reflectance = read_reflectance(r.context, r.object, "specular_reflectance");
    r.color("specular_transmittance", p.specular_transmittance);
    if constexpr (std::is_same_v<Dielectric, RoughDielectricMaterial>) {
        if (p.eta == 1) r.object.fail("'int_ior' and 'ext_ior' must differ");
        p.distribution = read_distribution(r.object);
        p.alpha = read_alpha(r.object);
    }
    return Dielectric(p);
}

template <class Plastic>
Material read_plastic(Reader& r) {
    typename Plastic::Parameters p;
    p.eta = read_eta(r.object, "polypropylene", 1);
    r.color("diffuse_reflectance", p.diffuse_reflectance);
    p.specular_reflectance = read_reflectance(r.context, r.object, "specular_reflectance");
    p.nonlinear = r.object.boolean("nonlinear", false);
    if constexpr (std::is_same_v<Plastic, RoughPlasticMaterial>) {
        p.distribution = read_distribution(r.object);
        p.alpha = read_alpha(r.object);
    }
    return Plastic(p);
}

struct Row {
    std::string_view type;
    Material (*read)(Reader&);
};
constexpr std::array kSimple{
    Row{"diffuse", read_diffuse},
    Row{"roughdiffuse", read_rough_diffuse},
    Row{"conductor", read_conductor<ConductorMaterial>},
    Row{"roughconductor", read_conductor<RoughConductorMaterial>},
    Row{"dielectric", read_dielectric<DielectricMaterial>},
    Row{"thindielectric", read_dielectric<ThinDielectricMaterial>},
    Row{"roughdielectric", read_dielectric<RoughDielectricMaterial>},
    Row{"plastic", read_plastic<PlasticMaterial>},
    Row{"roughplastic", read_plastic<RoughPlasticMaterial>},
};

bool is_transmissive(const SurfaceMaterial& surface) {
    return (lobes(surface.front.layer.material) & kTransmissiveLobe) != 0;
}

bool is_opaque(const SurfaceMaterial& surface) {
    return surface.opacity.texture == kNoTexture && surface.opacity.value == 1;
}

std::vector<Object*> nested(Object& object, std::size_t least, std::size_t most) {
    std::vector<Object*> children = object.children_of("bsdf");
    if (children.size() < least || children.size() > most) {
        object.fail("expected " + std::to_string(least) +
                    (most > least ? " or " + std::to_string(most) : "") + " nested bsdf, found " +
                    std::to_string(children.size()));
    }
    return children;
}

}  // namespace

std::size_t Bsdfs::index_of(Object& object) {
    const auto [known, is_new] = indices_.try_emplace(&object, 0);
    if (is_new) {
        SurfaceMaterial surface = read_surface(object);
        surface.name = object.id;
        known->second = context_.scene.materials.size();
        context_.scene.materials.push_back(std::move(surface));
    }
    return known->second;
}

std::size_t Bsdfs::default_index(bool emits) {
    // In version 0.6 a light without a material is black.
    const bool is_black = emits && context_.is_old;
    const auto [known, is_new] = default_indices_.try_emplace(is_black, 0);
    if (is_new) {
        const float grey = is_black ? 0 : 0.5F;
        known->second = context_.scene.materials.size();
        context_.scene.materials.push_back(
            {.name = "default",
             .front = {.layer = {.material = DiffuseMaterial{{grey, grey, grey}}}},
             .back = SurfaceMaterial::Back::Black});
    }
    return known->second;
}

SurfaceMaterial Bsdfs::read_surface(Object& object) {
    if (object.type == "twosided") return read_twosided(object);
    if (object.type == "mask") return read_mask(object);
    if (object.type == "blendbsdf") return read_blend(object);
    return read_simple(object);
}

SurfaceMaterial Bsdfs::read_simple(Object& object) {
    SurfaceMaterial surface;
    if (object.type == "null") {
        // All light goes on: nothing of this material is ever met.
        surface.opacity.value = 0;
        object.expect_all_read();
        return surface;
    }
    const auto* row = std::find_if(kSimple.begin(), kSimple.end(),
                                   [&](const Row& r) { return r.type == object.type; });
    if (row == kSimple.end()) object.refuse_type(kKnown);
    Reader reader{context_, textures_, object};
    surface.front.layer.material = row->read(reader);
    surface.front.layer.color_texture = reader.color_texture;
    object.expect_all_read();
    surface.back =
        is_transmissive(surface) ? SurfaceMaterial::Back::Same : SurfaceMaterial::Back::Black;
    return surface;
}

SurfaceMaterial Bsdfs::read_twosided(Object& object) {
    const std::vector<Object*> children = nested(object, 1, 2);
    object.expect_all_read();
    std::vector<SurfaceMaterial> sides;
    for (Object* child : children) {
        sides.push_back(read_surface(*child));
        if (!is_opaque(sides.back()) || sides.back().back != SurfaceMaterial::Back::Black) {
            child->fail("twosided takes opaque, reflective, one-sided materials only");
        }
    }
    SurfaceMaterial surface = std::move(sides[0]);
    surface.back = SurfaceMaterial::Back::Same;
    if (sides.size() == 2) {
        surface.back = SurfaceMaterial::Back::Other;
        surface.other_back = std::move(sides[1].front);
    }
    return surface;
}

SurfaceMaterial Bsdfs::read_mask(Object& object) {
    const TexturedNumber opacity = textures_.read_number(object, "opacity", 0.5F);
    Object& inner = *nested(object, 1, 1)[0];
    object.expect_all_read();
    SurfaceMaterial surface = read_surface(inner);
    if (!is_opaque(surface)) inner.fail("a mask in a mask is not supported");
    surface.opacity = opacity;
    return surface;
}

SurfaceMaterial Bsdfs::read_blend(Object& object) {
    if (!object.has("weight")) object.fail("missing 'weight'");
    const TexturedNumber weight = textures_.read_number(object, "weight", 0);
    const std::vector<Object*> children = nested(object, 2, 2);
    object.expect_all_read();
    std::array<SurfaceMaterial, 2> parts;
    for (std::size_t i = 0; i < 2; ++i) {
        parts[i] = read_surface(*children[i]);
        if (!is_opaque(parts[i]) || parts[i].front.other ||
            parts[i].back == SurfaceMaterial::Back::Other) {
            children[i]->fail(
                "blendbsdf takes materials that are not masks, blends, or of two kinds");
        }
    }
    if (parts[0].back != parts[1].back) {
        object.fail(
            "a blend of one-sided with two-sided or transmissive materials is not supported");
    }
    SurfaceMaterial surface = std::move(parts[0]);
    surface.front.other = std::move(parts[1].front.layer);
    surface.front.other_weight = weight;
    return surface;
}

}  // namespace misbench::mitsuba
