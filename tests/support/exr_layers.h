// The layers of an EXR file, read without the code that wrote them.
#pragma once

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>

#include <filesystem>
#include <map>
#include <string>

#include "renderer/image/image.h"

namespace misbench::test {

// By the name before ".R", ".G" and ".B"; "" is the one of R, G and B.
inline std::map<std::string, Image> exr_layers(const std::filesystem::path& path) {
    Imf::InputFile file(path.c_str());
    const Imath::Box2i window = file.header().dataWindow();
    const Image black(window.max.x + 1, window.max.y + 1);
    std::map<std::string, Image> layers;
    Imf::FrameBuffer buffer;
    const Imf::ChannelList& channels = file.header().channels();
    for (auto c = channels.begin(); c != channels.end(); ++c) {
        const std::string channel = c.name();
        const std::string name = channel.size() < 2 ? "" : channel.substr(0, channel.size() - 2);
        Image& image = layers.try_emplace(name, black).first->second;
        float* first = image.rgb.data() + std::string("RGB").find(channel.back());
        buffer.insert(channel, Imf::Slice::Make(Imf::FLOAT, first, window, 3 * sizeof(float)));
    }
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
    return layers;
}

}  // namespace misbench::test
