// Materials, textures, colours, lights and cameras of Mitsuba's XML scenes. Numbers marked (M3)
// were taken from Mitsuba 3.9 itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "renderer/image/image.h"
#include "renderer/scene/mitsuba/indices.h"
#include "tests/support/mitsuba_fixture.h"

namespace misbench::test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using Back = SurfaceMaterial::Back;

std::string bsdf(const std::string& type, const std::string& inside = "") {
    return "<bsdf type=\"" + type + "\">" + inside + "</bsdf>";
}
std::string value(const std::string& tag, const std::string& name, const std::string& text) {
    return "<" + tag + " name=\"" + name + "\" value=\"" + text + "\"/>";
}
std::string bitmap(const std::string& name, const std::string& file,
                   const std::string& inside = "") {
    return "<texture type=\"bitmap\" name=\"" + name + "\">" + value("string", "filename", file) +
           inside + "</texture>";
}

class MitsubaLook : public Mitsuba {
 protected:
    template <class M>
    bool front_is(const std::string& xml, const std::string& version = "3.0.0") const {
        return std::holds_alternative<M>(material(xml, version).front.layer.material);
    }
    Rgb reflectance(const std::string& color, const std::string& version = "3.0.0") const {
        return std::get<DiffuseMaterial>(
                   material(bsdf("diffuse", color), version).front.layer.material)
            .reflectance;
    }
    Rgb emission(const std::string& color, const std::string& version = "3.0.0") const {
        return rectangle("<emitter type=\"area\">" + color + "</emitter>", version)
            .meshes.at(0)
            .emission;
    }
    BitmapTexture bitmap_of(const std::string& inside, const std::string& version = "3.0.0") const {
        const SceneDescription scene =
            rectangle(bsdf("diffuse", bitmap("reflectance", "rgb.tga", inside)), version);
        EXPECT_EQ(scene.materials.at(0).front.layer.color_texture, 0);
        return std::get<BitmapTexture>(scene.textures.at(0));
    }
};

// --- Colours --------------------------------------------------------------------------------

TEST_F(MitsubaLook, ReadsColoursInAllTheirSpellings) {
    expect_near(reflectance(value("rgb", "reflectance", "0.1, 0.2,0.3")), {0.1F, 0.2F, 0.3F});
    expect_near(reflectance(value("rgb", "reflectance", "0.1 0.2 0.3")), {0.1F, 0.2F, 0.3F});
    expect_near(reflectance(value("rgb", "reflectance", "0.4")), {0.4F, 0.4F, 0.4F});
    expect_near(reflectance(value("float", "reflectance", "0.4")), {0.4F, 0.4F, 0.4F});
    expect_near(reflectance(value("spectrum", "reflectance", "0.3")), {0.3F, 0.3F, 0.3F});
    expect_near(reflectance(value("srgb", "reflectance", "#ff8000"), "0.6.0"), {1, 0.2158605F, 0});
    expect_near(reflectance(value("srgb", "reflectance", "0.5"), "0.6.0"),
                {0.2140411F, 0.2140411F, 0.2140411F});
    expect_near(reflectance(value("spectrum", "reflectance", "0.1 0.2 0.3"), "0.6.0"),
                {0.1F, 0.2F, 0.3F});
    EXPECT_THAT(shape_error(bsdf("diffuse", value("rgb", "reflectance", "1.3"))),
                HasSubstr("'reflectance': must be between 0 and 1"));
    EXPECT_THAT(shape_error(bsdf("diffuse", value("rgb", "reflectance", "0.1 0.2"))),
                HasSubstr("expected one or three numbers, found 2"));
    EXPECT_THAT(shape_error(bsdf("diffuse", value("spectrum", "reflectance", "400:0, 700:1"))),
                HasSubstr("by wavelength is supported for emission only"));
    EXPECT_THAT(
        shape_error("<emitter type=\"area\">" + value("rgb", "radiance", "-1") + "</emitter>"),
        HasSubstr("'radiance': must not be negative"));
}

TEST_F(MitsubaLook, ReadsEmissionSpectraAsMitsubaDoes) {
    expect_near(emission(value("rgb", "radiance", "17, 12, 4")), {17, 12, 4});
    // A uniform spectrum is the white of equal energy (M3).
    expect_near(emission(value("spectrum", "radiance", "2")), {2.40959F, 1.89658F, 1.81783F},
                1e-4F);
    expect_near(emission(value("spectrum", "radiance", "2"), "0.6.0"), {2, 2, 2});
    // The fitted matching functions are good to 1 % (M3).
    expect_near(emission(value("spectrum", "radiance", "400:0, 500:1, 700:0")),
                {0.342808F, 0.800695F, 0.452278F}, 0.01F);
    expect_near(emission(value("spectrum", "radiance", "360:1, 830:1")),
                {1.204884F, 0.948228F, 0.909267F}, 0.012F);
}

TEST_F(MitsubaLook, ReadsBlackbodiesWithANote) {
    const std::string light =
        "<emitter type=\"area\"><spectrum name=\"radiance\" type=\"blackbody\">" +
        value("float", "temperature", "6504") + value("float", "scale", "2") +
        "</spectrum></emitter>";
    const SceneDescription scene = rectangle(light);
    const Rgb color = scene.meshes.at(0).emission;
    // The peak of Planck's law is at 445.5 nm: 4.76e4 W / (m² sr nm); D65 is nearly white.
    EXPECT_GT(luminance(color), 2 * 4.0e4F);
    EXPECT_LT(luminance(color), 2 * 4.77e4F);
    EXPECT_NEAR(color.r / color.g, 1, 0.06);
    EXPECT_NEAR(color.b / color.g, 1, 0.06);
    EXPECT_THAT(scene.notes, Contains(HasSubstr("blackbody of 6504 K read as rgb")));
    const Rgb old =
        emission("<blackbody name=\"radiance\" temperature=\"6504K\" scale=\"2\"/>", "0.6.0");
    expect_near(old, color, 1);
    EXPECT_THAT(shape_error("<emitter type=\"area\"><spectrum name=\"radiance\" type=\"sunlight\"/>"
                            "</emitter>"),
                HasSubstr("spectrum 'sunlight' is not supported; known: blackbody"));
}

// --- Materials ------------------------------------------------------------------------------

TEST_F(MitsubaLook, ReadsEveryMaterialInBothDialects) {
    EXPECT_TRUE(front_is<DiffuseMaterial>(bsdf("diffuse")));
    EXPECT_TRUE(front_is<RoughDiffuseMaterial>(bsdf("roughdiffuse", value("float", "alpha", "1")),
                                               "0.6.0"));
    EXPECT_TRUE(
        front_is<ConductorMaterial>(bsdf("conductor", value("string", "material", "none"))));
    const std::string index = value("rgb", "eta", "1 2 3") + value("rgb", "k", "4");
    EXPECT_TRUE(front_is<ConductorMaterial>(bsdf("conductor", index)));
    EXPECT_TRUE(front_is<RoughConductorMaterial>(
        bsdf("roughconductor", index + value("float", "extEta", "1") +
                                   value("rgb", "specularReflectance", "0.5") +
                                   value("string", "distribution", "ggx") +
                                   value("boolean", "sampleVisible", "true")),
        "0.6.0"));
    const std::string glass = value("float", "intIOR", "1.5") + value("string", "extIOR", "water");
    EXPECT_TRUE(front_is<DielectricMaterial>(bsdf("dielectric", glass), "0.6.0"));
    EXPECT_TRUE(front_is<ThinDielectricMaterial>(bsdf("thindielectric", glass)));
    EXPECT_TRUE(front_is<RoughDielectricMaterial>(bsdf("roughdielectric", glass)));
    EXPECT_TRUE(front_is<PlasticMaterial>(bsdf("plastic", value("boolean", "nonlinear", "true"))));
    EXPECT_TRUE(front_is<RoughPlasticMaterial>(
        bsdf("roughplastic",
             glass + value("rgb", "diffuseReflectance", "0.5") + value("float", "alpha", "0.2")),
        "0.6.0"));
}

// Of an object with these parameters.
mitsuba::Object conductor(const std::vector<std::array<const char*, 3>>& parameters) {
    mitsuba::Object object;
    for (const auto& [type, name, text] : parameters) {
        mitsuba::Property& property = object.properties.emplace_back();
        property.type = type;
        property.name = name;
        property.attributes["value"] = text;
    }
    return object;
}

TEST_F(MitsubaLook, TakesTheIndicesOfMetalsOverWhatIsOutside) {
    mitsuba::Context old{.folder = folder_, .is_old = true};
    mitsuba::Context now{.folder = folder_, .is_old = false};
    mitsuba::Object in_water = conductor(
        {{"rgb", "eta", "1.333, 2.666, 0"}, {"rgb", "k", "3.999"}, {"string", "ext_eta", "water"}});
    const mitsuba::ComplexIndex index = mitsuba::read_complex_index(old, in_water);
    expect_near(index.eta, {1, 2, 0});
    expect_near(index.k, {3, 3, 3});
    mitsuba::Object plain = conductor({{"rgb", "eta", "1.5"}});
    expect_near(mitsuba::read_complex_index(old, plain).eta.r * kWhite,
                (1.5F / 1.000277F) * kWhite);
    expect_near(mitsuba::read_complex_index(now, plain).eta, 1.5F * kWhite);
    expect_near(mitsuba::read_complex_index(now, plain).k, kWhite);
    mitsuba::Object mirror = conductor({{"string", "material", "none"}});
    EXPECT_EQ(mitsuba::read_complex_index(now, mirror).eta, Rgb{});
    mitsuba::Object glass = conductor({{"string", "int_ior", "bk7"}, {"float", "ext_ior", "1.2"}});
    EXPECT_EQ(mitsuba::read_ior(glass, "int_ior", "air"), 1.5046F);
    EXPECT_EQ(mitsuba::read_ior(glass, "ext_ior", "air"), 1.2F);
    EXPECT_EQ(mitsuba::read_ior(glass, "other", "air"), 1.000277F);
}

TEST_F(MitsubaLook, RefusesWhatMaterialsCannotModelByName) {
    EXPECT_THAT(shape_error(bsdf("phong")),
                HasSubstr("bsdf 'phong' is not supported; known: diffuse"));
    for (const char* type : {"bumpmap", "normalmap", "principled", "ward", "coating"}) {
        EXPECT_THAT(shape_error(bsdf(type)),
                    HasSubstr(std::string("bsdf '") + type + "' is not supported"));
    }
    EXPECT_THAT(shape_error(bsdf("roughconductor", value("string", "distribution", "phong"))),
                HasSubstr("distribution 'phong' is not supported; known: beckmann ggx"));
    EXPECT_THAT(shape_error(bsdf("roughconductor", value("float", "alpha_u", "0.2"))),
                HasSubstr("anisotropic roughness is not supported"));
    EXPECT_EQ(shape_error(bsdf("roughconductor", value("float", "alpha_u", "0.2") +
                                                     value("float", "alpha_v", "0.2"))),
              "no error");
    EXPECT_THAT(shape_error(bsdf("roughplastic", bitmap("alpha", "rgb.tga"))),
                HasSubstr("'alpha' of bsdf 'roughplastic' cannot be a texture"));
    EXPECT_THAT(shape_error(bsdf("plastic", bitmap("specular_reflectance", "rgb.tga"))),
                HasSubstr("a texture cannot stand for 'specular_reflectance'"));
    EXPECT_THAT(shape_error(bsdf("roughplastic", value("float", "alpha", "0"))),
                HasSubstr("'alpha' must be between 1e-4 and 1"));
    EXPECT_THAT(shape_error(bsdf("plastic", value("float", "int_ior", "1"))),
                HasSubstr("'int_ior' must be above 'ext_ior'"));
    EXPECT_THAT(shape_error(bsdf("dielectric", value("string", "int_ior", "cheese"))),
                AllOf(HasSubstr("'int_ior': unknown material 'cheese'; known: vacuum"),
                      HasSubstr(" bk7 ")));
    EXPECT_THAT(shape_error(bsdf("conductor",
                                 value("string", "material", "Au") + value("rgb", "eta", "1"))),
                HasSubstr("has both 'material' and 'eta' or 'k'"));
    EXPECT_THAT(shape_error(bsdf("diffuse") + bsdf("diffuse")),
                HasSubstr("more than one bsdf is not supported"));
}

TEST_F(MitsubaLook, GivesBareMaterialsABlackBackUnlessTheyTransmit) {
    EXPECT_EQ(material(bsdf("diffuse")).back, Back::Black);
    EXPECT_EQ(material("").back, Back::Black);
    EXPECT_EQ(material(bsdf("dielectric")).back, Back::Same);
    EXPECT_EQ(material(bsdf("twosided", bsdf("diffuse"))).back, Back::Same);
    const SurfaceMaterial two = material(bsdf("twosided", bsdf("diffuse") + bsdf("conductor")));
    EXPECT_EQ(two.back, Back::Other);
    EXPECT_TRUE(std::holds_alternative<DiffuseMaterial>(two.front.layer.material));
    EXPECT_TRUE(std::holds_alternative<ConductorMaterial>(two.other_back->layer.material));
    for (const std::string& inner :
         {bsdf("dielectric"), bsdf("mask", bsdf("diffuse")), bsdf("twosided", bsdf("diffuse"))}) {
        EXPECT_THAT(shape_error(bsdf("twosided", inner)),
                    HasSubstr("twosided takes opaque, reflective, one-sided"));
    }
    EXPECT_THAT(shape_error(bsdf("twosided")), HasSubstr("expected 1 or 2 nested bsdf, found 0"));
}

TEST_F(MitsubaLook, GivesAnOldLightWithoutMaterialABlackOne) {
    const std::string light =
        "<emitter type=\"area\">" + value("rgb", "radiance", "1") + "</emitter>";
    const auto grey = [&](const char* version) {
        return std::get<DiffuseMaterial>(
                   rectangle(light, version).materials.at(0).front.layer.material)
            .reflectance.r;
    };
    EXPECT_EQ(grey("0.6.0"), 0);
    EXPECT_EQ(grey("3.0.0"), 0.5F);
}

TEST_F(MitsubaLook, ReadsMasksAndBlends) {
    const SurfaceMaterial mask = material(
        bsdf("mask", value("float", "opacity", "0.25") + bsdf("twosided", bsdf("diffuse"))));
    EXPECT_EQ(mask.opacity.value, 0.25F);
    EXPECT_EQ(mask.back, Back::Same);
    EXPECT_EQ(material(bsdf("null")).opacity.value, 0);
    const SurfaceMaterial blend = material(
        bsdf("blendbsdf", value("float", "weight", "0.75") + bsdf("diffuse") + bsdf("conductor")));
    EXPECT_TRUE(std::holds_alternative<DiffuseMaterial>(blend.front.layer.material));
    EXPECT_TRUE(std::holds_alternative<ConductorMaterial>(blend.front.other->material));
    EXPECT_EQ(blend.front.other_weight.value, 0.75F);
    EXPECT_EQ(blend.back, Back::Black);
    const std::string weight = value("float", "weight", "0.5");
    EXPECT_THAT(shape_error(bsdf("blendbsdf", weight + bsdf("diffuse") + bsdf("dielectric"))),
                HasSubstr("a blend of one-sided with two-sided or transmissive"));
    EXPECT_THAT(shape_error(bsdf("mask", bsdf("mask", bsdf("diffuse")))),
                HasSubstr("a mask in a mask"));
    EXPECT_THAT(shape_error(bsdf("null") + "<emitter type=\"area\"/>"),
                HasSubstr("on a surface with a mask"));
}

// --- Textures -------------------------------------------------------------------------------

TEST_F(MitsubaLook, ReadsBitmapsInBothDialects) {
    const BitmapTexture plain = bitmap_of("");
    EXPECT_EQ(plain.filter, BitmapTexture::Filter::Bilinear);
    EXPECT_EQ(plain.wrap, BitmapTexture::Wrap::Repeat);
    EXPECT_EQ(plain.to_uv, kIdentityUv);
    const BitmapTexture set =
        bitmap_of(value("string", "filter_type", "nearest") +
                  value("string", "wrap_mode", "clamp") + value("boolean", "raw", "true") +
                  "<transform name=\"to_uv\"><scale x=\"2\" y=\"3\"/><translate x=\"0.25\" "
                  "y=\"0.5\"/></transform>");
    EXPECT_EQ(set.filter, BitmapTexture::Filter::Nearest);
    EXPECT_EQ(set.wrap, BitmapTexture::Wrap::Clamp);
    EXPECT_EQ(set.to_uv, (UvTransform{{{2, 0, 0.25F}, {0, 3, 0.5F}}}));
    const BitmapTexture old =
        bitmap_of(value("string", "filterType", "trilinear") +
                      value("string", "wrapMode", "mirror") + value("float", "gamma", "1") +
                      value("float", "uscale", "2") + value("float", "voffset", "0.5"),
                  "0.6.0");
    EXPECT_EQ(old.filter, BitmapTexture::Filter::Bilinear);
    EXPECT_EQ(old.wrap, BitmapTexture::Wrap::Mirror);
    EXPECT_EQ(old.to_uv, (UvTransform{{{2, 0, 0}, {0, 1, 0.5F}}}));
    const auto error = [&](const std::string& inside) {
        return shape_error(bsdf("diffuse", bitmap("reflectance", "rgb.tga", inside)), "0.6.0");
    };
    EXPECT_THAT(error(value("string", "wrapMode", "zero")),
                HasSubstr("unknown wrap mode 'zero'; known: repeat mirror clamp"));
    EXPECT_THAT(error(value("string", "wrapModeU", "clamp")),
                HasSubstr("different wrap modes for u and v"));
    EXPECT_THAT(error(value("float", "gamma", "2.2")),
                HasSubstr("a gamma other than 1 is not supported"));
    EXPECT_THAT(error(value("string", "channel", "r")),
                HasSubstr("channel 'r' is not supported; known: a"));
    EXPECT_THAT(shape_error(bsdf("diffuse", bitmap("reflectance", "none.tga"))),
                HasSubstr("none.tga"));
    EXPECT_THAT(
        shape_error(bsdf("diffuse", "<texture type=\"wireframe\" name=\"reflectance\"/>")),
        HasSubstr("texture 'wireframe' is not supported; known: bitmap checkerboard scale"));
}

TEST_F(MitsubaLook, ReadsAnImageOnceForAllItsUses) {
    const SceneDescription scene =
        read("<shape type=\"cube\">" + bsdf("diffuse", bitmap("reflectance", "rgb.tga")) +
             "</shape>" + "<shape type=\"cube\">" +
             bsdf("diffuse",
                  bitmap("reflectance", "rgb.tga", value("string", "filter_type", "nearest"))) +
             "</shape>");
    ASSERT_EQ(scene.textures.size(), 2U);
    EXPECT_EQ(std::get<BitmapTexture>(scene.textures[0]).image,
              std::get<BitmapTexture>(scene.textures[1]).image);
}

TEST_F(MitsubaLook, TakesTheAlphaChannelWhereANumberIsWanted) {
    const auto mask = [&](const std::string& file) {
        return rectangle(
            bsdf("mask", bitmap("opacity", file) + bsdf("diffuse", bitmap("reflectance", file))));
    };
    const auto channel = [](const SceneDescription& scene, std::int32_t texture) {
        return std::get<BitmapTexture>(scene.textures.at(static_cast<std::size_t>(texture)))
            .channel;
    };
    const SceneDescription scene = mask("rgba.tga");
    const SurfaceMaterial& surface = scene.materials.at(0);
    EXPECT_EQ(channel(scene, surface.opacity.texture), BitmapTexture::Channel::Alpha);
    EXPECT_EQ(channel(scene, surface.front.layer.color_texture), BitmapTexture::Channel::Color);
    EXPECT_THAT(scene.notes, Contains(HasSubstr("alpha channel of 'rgba.tga'")));
    const SceneDescription opaque = mask("rgb.tga");
    EXPECT_EQ(channel(opaque, opaque.materials.at(0).opacity.texture),
              BitmapTexture::Channel::Color);
    EXPECT_THAT(opaque.notes, IsEmpty());
}

TEST_F(MitsubaLook, ReadsCheckerboardsAndScaledTextures) {
    const auto texture = [&](const std::string& inside, const char* version) {
        return rectangle(bsdf("diffuse", inside), version).textures.at(0);
    };
    const std::string checkerboard =
        value("rgb", "color1", "0.5") +
        "<transform name=\"to_uv\"><scale x=\"8\" y=\"4\"/></transform>";
    const auto plain = std::get<CheckerboardTexture>(texture(
        "<texture type=\"checkerboard\" name=\"reflectance\">" + checkerboard + "</texture>",
        "3.0.0"));
    EXPECT_EQ(plain.color0, (Rgb{0.4F, 0.4F, 0.4F}));
    EXPECT_EQ(plain.color1, (Rgb{0.5F, 0.5F, 0.5F}));
    EXPECT_EQ(plain.to_uv, (UvTransform{{{8, 0, 0}, {0, 4, 0}}}));
    const auto scaled = [&](const std::string& inner) {
        return texture("<texture type=\"scale\" name=\"reflectance\">" +
                           value("float", "scale", "0.5") + inner + "</texture>",
                       "0.6.0");
    };
    EXPECT_EQ(std::get<BitmapTexture>(scaled(bitmap("", "rgb.tga"))).scale, 0.5F);
    EXPECT_EQ(std::get<CheckerboardTexture>(scaled("<texture type=\"checkerboard\"/>")).color0.g,
              0.2F);
}

// --- Lights ---------------------------------------------------------------------------------

TEST_F(MitsubaLook, ReadsLightsThatAreNotSurfaces) {
    const SceneDescription scene =
        read("<emitter type=\"point\"><point name=\"position\" x=\"1\" z=\"2\"/>" +
             value("rgb", "intensity", "3") + "</emitter>" + "<emitter type=\"point\">" +
             to_world("<translate y=\"4\"/>") + "</emitter>" + "<emitter type=\"spot\">" +
             to_world("<lookat origin=\"0 5 0\" target=\"0 0 0\" up=\"1 0 0\"/>") + "</emitter>" +
             "<emitter type=\"directional\"><vector name=\"direction\" y=\"-2\"/>" +
             value("rgb", "irradiance", "7") + "</emitter>" + "<emitter type=\"directional\">" +
             to_world("<rotate y=\"1\" angle=\"90\"/>") + "</emitter>" +
             "<emitter type=\"constant\">" + value("rgb", "radiance", "1 2 3") + "</emitter>");
    EXPECT_EQ(scene.point_lights.at(0).position, (Vec3{1, 0, 2}));
    EXPECT_EQ(scene.point_lights[0].intensity, (Rgb{3, 3, 3}));
    EXPECT_EQ(scene.point_lights.at(1).position, (Vec3{0, 4, 0}));
    expect_near(scene.spot_lights.at(0).direction, {0, -1, 0});
    EXPECT_NEAR(scene.spot_lights[0].cutoff_angle, 20 * kPi / 180, 1e-6);
    EXPECT_NEAR(scene.spot_lights[0].beam_width, 15 * kPi / 180, 1e-6);
    expect_near(scene.directional_lights.at(0).direction, {0, -1, 0});
    EXPECT_EQ(scene.directional_lights[0].irradiance.r, 7);
    expect_near(scene.directional_lights.at(1).direction, {1, 0, 0});
    EXPECT_EQ(scene.environment->radiance->rgb, (std::vector<float>{1, 2, 3}));
    EXPECT_THAT(error_of("<emitter type=\"sky\"/>"),
                HasSubstr("emitter 'sky' is not supported; known: area constant"));
    EXPECT_THAT(error_of("<emitter type=\"area\"/>"), HasSubstr("belongs inside a shape"));
    EXPECT_THAT(error_of("<emitter type=\"constant\"/><emitter type=\"constant\"/>"),
                HasSubstr("more than one environment"));
    EXPECT_THAT(
        shape_error("<emitter type=\"area\">" + bitmap("radiance", "rgb.tga") + "</emitter>"),
        HasSubstr("a texture cannot stand for 'radiance'"));
}

// Our map's u runs from +x to +z; Mitsuba's from -z by way of +x (M3: +x is a quarter, +z a half).
TEST_F(MitsubaLook, TurnsEnvironmentMapsIntoOurFrame) {
    Image image(8, 4);
    image.rgb[0] = 3;
    write_exr(folder_ / "sky.exr", image);
    const auto environment = [&](const std::string& inside) {
        return *read("<emitter type=\"envmap\">" + value("string", "filename", "sky.exr") + inside +
                     "</emitter>")
                    .environment;
    };
    const auto direction = [](const EnvironmentDescription& e, float u) {
        const float phi = 2 * kPi * u;
        return e.to_world.direction({std::cos(phi), 0, std::sin(phi)});
    };
    const EnvironmentDescription plain = environment(value("float", "scale", "2"));
    EXPECT_EQ(plain.radiance->rgb[0], 6);
    EXPECT_EQ(plain.filter, EnvironmentDescription::Filter::Bilinear);
    expect_near(direction(plain, 0), {0, 0, -1});
    expect_near(direction(plain, 0.25F), {1, 0, 0});
    expect_near(direction(plain, 0.5F), {0, 0, 1});
    expect_near(plain.to_world.direction({0, 1, 0}), {0, 1, 0});
    const EnvironmentDescription turned = environment(to_world("<rotate y=\"1\" angle=\"90\"/>"));
    expect_near(direction(turned, 0.25F), {0, 0, -1});
    EXPECT_THAT(error_of("<emitter type=\"envmap\">" + value("string", "filename", "sky.exr") +
                         to_world("<scale value=\"2\"/>") + "</emitter>"),
                HasSubstr("'to_world' scales or shears"));
}

// --- Cameras --------------------------------------------------------------------------------

TEST_F(MitsubaLook, TurnsCamerasToLookAlongTheirNegativeZ) {
    const PerspectiveCamera c =
        camera(value("float", "fov", "40") +
               to_world("<lookat origin=\"1 2 3\" target=\"1 2 -7\" up=\"0 1 0\"/>"));
    expect_near(c.to_world.translation(), {1, 2, 3});
    expect_near(c.to_world.direction({0, 0, -1}), {0, 0, -1});
    expect_near(c.to_world.direction({1, 0, 0}), {1, 0, 0});
    expect_near(c.to_world.direction({0, 1, 0}), {0, 1, 0});
    // An identity looks along +z, with +x to the left of the picture (M3).
    const PerspectiveCamera identity = camera(value("float", "fov", "40"));
    expect_near(identity.to_world.direction({1, 0, -1}), {-1, 0, 1});
    EXPECT_EQ(identity.lens_radius, 0);
}

TEST_F(MitsubaLook, ReadsAnglesFilmsAndLenses) {
    using Axis = PerspectiveCamera::FovAxis;
    const std::string fov = value("float", "fov", "40");
    EXPECT_EQ(camera(fov).fov_axis, Axis::Horizontal);
    EXPECT_EQ(camera(fov + value("string", "fovAxis", "y")).fov_axis, Axis::Vertical);
    EXPECT_EQ(camera(fov + value("string", "fov_axis", "smaller")).fov_axis, Axis::Smaller);
    const PerspectiveCamera focal = camera(value("string", "focal_length", "50mm"));
    EXPECT_EQ(focal.fov_axis, Axis::Diagonal);
    EXPECT_NEAR(focal.fov_degrees, 46.793, 1e-3);  // M3, as camera("") too
    EXPECT_EQ(camera("").fov_degrees, focal.fov_degrees);
    const SceneDescription cropped =
        read_all("<sensor type=\"thinlens\">" + fov + value("float", "aperture_radius", "0.25") +
                 value("float", "focus_distance", "18") + value("float", "near_clip", "1") +
                 "<sampler type=\"independent\">" + value("integer", "sample_count", "4") +
                 "</sampler>" + "<film type=\"hdrfilm\">" + value("integer", "width", "200") +
                 value("integer", "height", "100") + value("integer", "crop_width", "50") +
                 value("integer", "crop_height", "40") + value("integer", "crop_offset_x", "150") +
                 value("integer", "crop_offset_y", "10") + value("string", "pixel_format", "rgb") +
                 "<rfilter type=\"tent\"/></film></sensor>");
    EXPECT_EQ(cropped.film.width, 50);
    EXPECT_EQ(cropped.film.height, 40);
    EXPECT_EQ(cropped.camera.window.x0, 0.75F);
    EXPECT_EQ(cropped.camera.window.x1, 1);
    EXPECT_EQ(cropped.camera.window.y0, 0.1F);
    EXPECT_EQ(cropped.camera.window.y1, 0.5F);
    EXPECT_EQ(cropped.camera.lens_radius, 0.25F);
    EXPECT_EQ(cropped.camera.focus_distance, 18);
    EXPECT_THAT(cropped.notes, AllOf(Contains(HasSubstr("filter 'tent' ignored")),
                                     Contains(HasSubstr("near and far clip"))));
    EXPECT_EQ(read("").film.width, 0);
}

TEST_F(MitsubaLook, RefusesCamerasThatItCannotModel) {
    const auto error = [&](const std::string& inside, const std::string& type = "perspective") {
        return message_of(
            [&] { read_all("<sensor type=\"" + type + "\">" + inside + "</sensor>"); });
    };
    EXPECT_THAT(error("", "orthographic"),
                HasSubstr("sensor 'orthographic' is not supported; known: perspective thinlens"));
    EXPECT_THAT(error(value("float", "fov", "180")), HasSubstr("'fov' must be between 0 and 180"));
    EXPECT_THAT(error(value("float", "fov", "40") + value("string", "fov_axis", "z")),
                HasSubstr("unknown fov_axis 'z'; known: x y diagonal"));
    EXPECT_THAT(error(value("string", "focal_length", "wide")), HasSubstr("must be like \"50mm\""));
    EXPECT_THAT(error(to_world("<scale value=\"2\"/>")), HasSubstr("scales or shears the camera"));
    EXPECT_EQ(error(to_world("<scale x=\"-1\"/>")), "no error");
    EXPECT_THAT(error(value("float", "principal_point_offset_x", "0.1")),
                HasSubstr("other than 0 is not supported"));
    EXPECT_THAT(error("", "thinlens"), HasSubstr("missing 'aperture_radius'"));
    EXPECT_THAT(error("<film type=\"hdrfilm\">" + value("integer", "crop_width", "5") + "</film>"),
                HasSubstr("a crop needs 'width' and 'height'"));
    EXPECT_THAT(error("<film type=\"hdrfilm\">" + value("integer", "width", "10") +
                      value("integer", "height", "10") + value("integer", "crop_offset_x", "5") +
                      "</film>"),
                HasSubstr("the crop reaches beyond the film"));
    EXPECT_THAT(error("<film type=\"hdrfilm\">" + value("integer", "widht", "10") + "</film>"),
                HasSubstr("unknown parameter 'widht' of film 'hdrfilm'"));
}

TEST_F(MitsubaLook, TellsWhatTheFilesIntegratorWanted) {
    EXPECT_THAT(read("<integrator type=\"path\">" + value("integer", "maxDepth", "65") +
                         value("boolean", "strictNormals", "true") + "</integrator>",
                     "0.6.0")
                    .notes,
                Contains("integrator 'path' of the file ignored: max_depth 65"));
}

}  // namespace
}  // namespace misbench::test
