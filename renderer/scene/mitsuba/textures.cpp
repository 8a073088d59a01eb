#include "renderer/scene/mitsuba/textures.h"

#include <array>

#include "renderer/base/names.h"
#include "renderer/scene/mitsuba/spectrum.h"

namespace misbench::mitsuba {
namespace {

struct NamedWrap {
    const char* name;
    BitmapTexture::Wrap wrap;
};
constexpr std::array kWraps{NamedWrap{"repeat", BitmapTexture::Wrap::Repeat},
                            NamedWrap{"mirror", BitmapTexture::Wrap::Mirror},
                            NamedWrap{"clamp", BitmapTexture::Wrap::Clamp}};

BitmapTexture::Wrap read_wrap(Object& object) {
    // Version 0.6 may name one for each direction.
    const std::string both = object.text("wrap_mode", "repeat");
    const std::string u = object.text("wrap_mode_u", both);
    const std::string v = object.text("wrap_mode_v", both);
    if (u != v) object.fail("different wrap modes for u and v are not supported");
    try {
        return find_named(kWraps, u, "wrap_mode", "wrap mode").wrap;
    } catch (const ParameterError& e) {
        object.fail(e.what());
    }
}

BitmapTexture::Filter read_filter(Context& context, Object& object) {
    const std::string filter = object.text("filter_type", context.is_old ? "ewa" : "bilinear");
    if (filter == "nearest") return BitmapTexture::Filter::Nearest;
    if (filter == "trilinear" || filter == "ewa") {
        context.note("bitmap filter '" + filter + "' read as bilinear");
    } else if (filter != "bilinear") {
        object.fail("unknown filter_type '" + filter + "'; known: bilinear nearest trilinear ewa");
    }
    return BitmapTexture::Filter::Bilinear;
}

TextureImage::Encoding read_encoding(Context& context, Object& object) {
    if (!context.is_old) {
        return object.boolean("raw", false) ? TextureImage::Encoding::Linear
                                            : TextureImage::Encoding::Srgb;
    }
    // -1: as the file says, which is sRGB for files of 8 bits.
    const float gamma = object.number("gamma", -1);
    if (gamma != 1 && gamma != -1) object.fail("a gamma other than 1 is not supported");
    return gamma == 1 ? TextureImage::Encoding::Linear : TextureImage::Encoding::Srgb;
}

}  // namespace

std::int32_t Textures::read_color_or_texture(Object& object, const std::string& name, Rgb& color) {
    Object* child = object.child(name);
    if (child == nullptr || child->tag != "texture") {
        color = read_color(context_, object, name, ColorRole::Reflectance, color);
        return kNoTexture;
    }
    return index_of(*child, Use::Color);
}

TexturedNumber Textures::read_number(Object& object, const std::string& name, float fallback) {
    Object* child = object.child(name);
    if (child != nullptr && child->tag == "texture") return {1, index_of(*child, Use::Number)};
    const Rgb value = read_color(context_, object, name, ColorRole::Reflectance,
                                 Rgb{fallback, fallback, fallback});
    if (value.r != value.g || value.g != value.b) object.fail("'" + name + "' must be grey");
    return {value.r, kNoTexture};
}

std::int32_t Textures::index_of(Object& object, Use use) {
    const auto [known, is_new] = indices_.try_emplace({&object, use}, kNoTexture);
    if (is_new) {
        Texture texture = read(object, use);
        object.expect_all_read();
        known->second = static_cast<std::int32_t>(context_.scene.textures.size());
        context_.scene.textures.push_back(std::move(texture));
    }
    return known->second;
}

Texture Textures::read(Object& object, Use use) {
    if (object.type == "bitmap") return read_bitmap(object, use);
    if (object.type == "scale") return read_scaled(object, use);
    if (object.type != "checkerboard") object.refuse_type("bitmap checkerboard scale");
    CheckerboardTexture checkerboard;
    checkerboard.color0 =
        read_color(context_, object, "color0", ColorRole::Reflectance, Rgb{0.4F, 0.4F, 0.4F});
    checkerboard.color1 =
        read_color(context_, object, "color1", ColorRole::Reflectance, Rgb{0.2F, 0.2F, 0.2F});
    checkerboard.to_uv = read_to_uv(object);
    return checkerboard;
}

Texture Textures::read_bitmap(Object& object, Use use) {
    const std::string file = object.text("filename");
    const TextureImage::Encoding encoding = read_encoding(context_, object);
    auto& image = images_[{file, encoding}];
    if (image == nullptr) {
        image = std::make_shared<const TextureImage>(
            TextureImage::read(context_.folder / file, encoding));
    }
    BitmapTexture bitmap;
    bitmap.image = image;
    bitmap.filter = read_filter(context_, object);
    bitmap.wrap = read_wrap(object);
    bitmap.to_uv = read_to_uv(object);
    // How the image is kept in memory and filtered when it is small in the picture.
    object.ignore({"format", "accel", "cache", "max_anisotropy"});
    if (const std::string channel = object.text("channel", ""); channel == "a") {
        bitmap.channel = BitmapTexture::Channel::Alpha;
    } else if (!channel.empty()) {
        object.fail("channel '" + channel + "' is not supported; known: a");
    } else if (use == Use::Number && image->has_alpha()) {
        bitmap.channel = BitmapTexture::Channel::Alpha;
        context_.note("alpha channel of '" + file + "' taken where a number is wanted");
    }
    return bitmap;
}

// Version 0.6: another texture times a number.
Texture Textures::read_scaled(Object& object, Use use) {
    const float scale = object.number("scale", 1);
    if (!(scale >= 0)) object.fail("'scale' must not be negative");
    const std::vector<Object*> children = object.children_of("texture");
    if (children.size() != 1) object.fail("expected one texture inside");
    Texture texture = read(*children[0], use);
    children[0]->expect_all_read();
    if (auto* bitmap = std::get_if<BitmapTexture>(&texture)) {
        bitmap->scale *= scale;
    } else {
        auto& checkerboard = std::get<CheckerboardTexture>(texture);
        checkerboard.color0 = scale * checkerboard.color0;
        checkerboard.color1 = scale * checkerboard.color1;
    }
    return texture;
}

UvTransform Textures::read_to_uv(Object& object) {
    if (context_.is_old) {
        // One scale for both may be given, and one for each.
        const float both = object.number("uvscale", 1);
        return {{{object.number("uscale", both), 0, object.number("uoffset", 0)},
                 {0, object.number("vscale", both), object.number("voffset", 0)}}};
    }
    const Transform t = object.transform("to_uv");
    return {
        {{t.rows[0][0], t.rows[0][1], t.rows[0][3]}, {t.rows[1][0], t.rows[1][1], t.rows[1][3]}}};
}

}  // namespace misbench::mitsuba
