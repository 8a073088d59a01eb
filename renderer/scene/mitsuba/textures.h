// Textures, each read once however many materials use it.
#pragma once

#include <map>
#include <memory>

#include "renderer/scene/mitsuba/context.h"
#include "renderer/scene/mitsuba/object.h"

namespace misbench::mitsuba {

class Textures {
 public:
    explicit Textures(Context& context) : context_(context) {}

    // Colour or texture; `color` stays as it was where a texture stands for it.
    // Returns the texture's index, or kNoTexture.
    std::int32_t read_color_or_texture(Object& object, const std::string& name, Rgb& color);
    // A number in [0, 1] or a texture. Where a bitmap has an alpha channel, that is the number.
    TexturedNumber read_number(Object& object, const std::string& name, float fallback);

 private:
    enum class Use { Color, Number };

    std::int32_t index_of(Object& object, Use use);
    Texture read(Object& object, Use use);
    Texture read_bitmap(Object& object, Use use);
    Texture read_scaled(Object& object, Use use);
    UvTransform read_to_uv(Object& object);

    Context& context_;
    std::map<std::pair<const Object*, Use>, std::int32_t> indices_;
    std::map<std::pair<std::string, TextureImage::Encoding>, std::shared_ptr<const TextureImage>>
        images_;
};

}  // namespace misbench::mitsuba
