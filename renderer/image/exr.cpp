#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfVersion.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <span>

#include "renderer/base/check.h"
#include "renderer/base/error.h"
#include "renderer/base/files.h"
#include "renderer/image/decode.h"
#include "renderer/image/image.h"

namespace misbench {
namespace {

constexpr std::array kColor = {"R", "G", "B"};
constexpr std::array kColorAndAlpha = {"R", "G", "B", "A"};
constexpr std::array kGrey = {"Y"};
constexpr std::array kGreyAndAlpha = {"Y", "A"};
using Channels = std::span<const char* const>;

// Interleaved floats that cover a window.
void insert(float* values, Channels channels, const std::string& prefix, const Imath::Box2i& window,
            Imf::FrameBuffer& buffer) {
    const std::size_t pixel_bytes = channels.size() * sizeof(float);
    for (std::size_t c = 0; c < channels.size(); ++c) {
        buffer.insert(prefix + channels[c],
                      Imf::Slice::Make(Imf::FLOAT, values + c, window, pixel_bytes));
    }
}

// Beyond what compression makes of an image of one colour: a short file must not make us allocate
// for pixels that it cannot hold.
constexpr std::int64_t kMaxPixelsPerByte = 16384;

// Collects a file in memory: the library's own file stream does not notice a full disk when its
// last buffer is written.
class MemoryStream final : public Imf::OStream {
 public:
    MemoryStream() : OStream("image") {}
    void write(const char c[], int n) override {
        const auto size = static_cast<std::size_t>(n);
        if (bytes_.size() < at_ + size) bytes_.resize(at_ + size);
        std::memcpy(bytes_.data() + at_, c, size);
        at_ += size;
    }
    std::uint64_t tellp() override { return at_; }
    void seekp(std::uint64_t position) override { at_ = position; }
    const std::string& bytes() const { return bytes_; }

 private:
    std::string bytes_;
    std::size_t at_ = 0;
};

// The bytes of a file, for reading.
class ByteStream final : public Imf::IStream {
 public:
    explicit ByteStream(const std::string& bytes) : IStream("image"), bytes_(bytes) {}
    bool read(char c[], int n) override {
        const auto size = static_cast<std::size_t>(n);
        if (at_ > bytes_.size() || bytes_.size() - at_ < size) {
            throw std::runtime_error("the file ends in the middle of its data");
        }
        std::memcpy(c, bytes_.data() + at_, size);
        at_ += size;
        return at_ < bytes_.size();
    }
    std::uint64_t tellg() override { return at_; }
    void seekg(std::uint64_t position) override { at_ = position; }

 private:
    const std::string& bytes_;
    std::size_t at_ = 0;
};

// In order, "" for what has none.
std::vector<std::string> layers_of(const Imf::ChannelList& list) {
    std::vector<std::string> layers;
    for (auto c = list.begin(); c != list.end(); ++c) {
        const std::string channel = c.name();
        const std::size_t dot = channel.rfind('.');
        const std::string layer = dot == std::string::npos ? "" : channel.substr(0, dot);
        if (std::ranges::find(layers, layer) == layers.end()) layers.push_back(layer);
    }
    return layers;
}

[[noreturn]] void refuse_channels(const Imf::ChannelList& list, const std::string& layer) {
    std::string found;
    for (auto c = list.begin(); c != list.end(); ++c) found += std::string(" ") + c.name();
    std::string what = layer.empty() ? "its channels are" + found + "; known: R G B, or Y, and A"
                                     : "it has no layer '" + layer + "' of R G B or Y";
    std::string layers;
    for (const std::string& name : layers_of(list)) layers += name.empty() ? "" : " " + name;
    throw std::runtime_error(what + (layers.empty() ? "" : "; its layers:" + layers));
}

// What the file has of what we read, with the prefix of a layer.
Channels channels_of(const Imf::ChannelList& list, const std::string& layer,
                     const std::string& prefix) {
    const auto has = [&](const char* name) { return list.findChannel(prefix + name) != nullptr; };
    const bool alpha = has("A");
    Channels channels;
    if (has("R") && has("G") && has("B")) {
        channels = alpha ? Channels(kColorAndAlpha) : Channels(kColor);
    } else if (has("Y") && !has("RY") && !has("BY")) {
        channels = alpha ? Channels(kGreyAndAlpha) : Channels(kGrey);
    } else {
        refuse_channels(list, layer);
    }
    for (const char* name : channels) {
        const Imf::Channel& channel = list[prefix + name];
        if (channel.xSampling != 1 || channel.ySampling != 1) {
            throw std::runtime_error("its channel " + prefix + name + " is subsampled");
        }
    }
    return channels;
}

struct Window {
    Imath::Box2i box;
    int width = 0;
    int height = 0;
};

// Of a file that can hold so many pixels.
Window window_of(const Imf::InputFile& file, std::size_t n_bytes) {
    if (Imf::isMultiPart(file.version())) throw std::runtime_error("it has several parts");
    const Imf::Header& header = file.header();
    const Imath::Box2i box = header.dataWindow();
    if (box != header.displayWindow()) {
        throw std::runtime_error("its data window is not its display window");
    }
    const std::int64_t width = std::int64_t{box.max.x} - box.min.x + 1;
    const std::int64_t height = std::int64_t{box.max.y} - box.min.y + 1;
    check_image_size(width, height);
    if (width * height / kMaxPixelsPerByte > static_cast<std::int64_t>(n_bytes)) {
        throw std::runtime_error("the file is too short for " + std::to_string(width) + " x " +
                                 std::to_string(height) + " pixels");
    }
    return {.box = box, .width = static_cast<int>(width), .height = static_cast<int>(height)};
}

void write_file(const std::filesystem::path& path, std::span<const ImageLayer> layers,
                Imf::Compression compression,
                const std::map<std::string, std::string>& attributes) {
    MISBENCH_CHECK(!layers.empty());
    const int width = layers[0].image->width;
    const int height = layers[0].image->height;
    MemoryStream stream;
    try {
        Imf::Header header(width, height);
        header.compression() = compression;
        for (const auto& [name, value] : attributes) {
            header.insert(name, Imf::StringAttribute(value));
        }
        Imf::FrameBuffer buffer;
        for (const auto& [name, image] : layers) {
            MISBENCH_CHECK(image->width == width && image->height == height);
            const std::string prefix = name.empty() ? "" : name + ".";
            // The writer only reads from the buffer; its interface is not const-correct.
            insert(const_cast<float*>(image->rgb.data()), kColor, prefix, header.dataWindow(),
                   buffer);
            for (const char* channel : kColor) {
                header.channels().insert(prefix + channel, Imf::Channel(Imf::FLOAT));
            }
        }
        Imf::OutputFile file(stream, header, 0);
        file.setFrameBuffer(buffer);
        file.writePixels(height);
    } catch (const std::exception& e) {
        throw Error(Errc::DataLoss, "write image '" + path.string() + "': " + e.what());
    }
    write_file_durably(path, stream.bytes());
}

// The names of layers with R G B, in the order of their channels: "" for a plain image's.
std::vector<std::string> layer_names(const Imf::ChannelList& channels) {
    std::vector<std::string> names;
    for (auto c = channels.begin(); c != channels.end(); ++c) {
        const std::string channel = c.name();
        if (channel == "R") names.emplace_back();
        if (channel.ends_with(".R")) names.push_back(channel.substr(0, channel.size() - 2));
    }
    return names;
}

}  // namespace

void write_exr(const std::filesystem::path& path, const Image& image,
               const std::map<std::string, std::string>& attributes) {
    write_file(path, std::array{ImageLayer{"", &image}}, Imf::NO_COMPRESSION, attributes);
}

void write_exr_layers(const std::filesystem::path& path, std::span<const ImageLayer> layers,
                      const std::map<std::string, std::string>& attributes) {
    // Fast, and what most layers need: they are black over large parts.
    write_file(path, layers, Imf::RLE_COMPRESSION, attributes);
}

Pixels decode_exr(const std::string& bytes, const std::string& layer) {
    ByteStream stream(bytes);
    Imf::InputFile file(stream, 0);
    const Window window = window_of(file, bytes.size());
    const std::string prefix = layer.empty() ? "" : layer + ".";
    const Channels channels = channels_of(file.header().channels(), layer, prefix);
    Pixels pixels{.width = window.width,
                  .height = window.height,
                  .n_channels = static_cast<int>(channels.size()),
                  .values = {}};
    std::vector<float> values(pixels.n_values());
    Imf::FrameBuffer buffer;
    insert(values.data(), channels, prefix, window.box, buffer);
    file.setFrameBuffer(buffer);
    file.readPixels(window.box.min.y, window.box.max.y);
    pixels.values = std::move(values);
    return pixels;
}

Image read_exr(const std::filesystem::path& path) {
    const std::string bytes = read_file(path);
    try {
        Pixels pixels = decode_exr(bytes);
        if (pixels.n_channels != 3) throw std::runtime_error("its channels are not R G B");
        Image image;
        image.width = pixels.width;
        image.height = pixels.height;
        image.rgb = std::get<std::vector<float>>(std::move(pixels.values));
        return image;
    } catch (const std::exception& e) {
        throw Error(Errc::DataLoss, "read image '" + path.string() + "': " + e.what());
    }
}

ExrLayers read_exr_layers(const std::filesystem::path& path,
                          const std::optional<std::vector<std::string>>& names) {
    const std::string bytes = read_file(path);
    try {
        ByteStream stream(bytes);
        Imf::InputFile file(stream, 0);
        const Window window = window_of(file, bytes.size());
        ExrLayers layers;
        for (const std::string& name : names ? *names : layer_names(file.header().channels())) {
            layers.images.push_back({name, Image(window.width, window.height)});
        }
        Imf::FrameBuffer buffer;
        for (auto& [name, image] : layers.images) {
            const std::string prefix = name.empty() ? "" : name + ".";
            for (const char* color : kColor) {
                const Imf::Channel* channel = file.header().channels().findChannel(prefix + color);
                const bool fits = channel != nullptr && channel->type == Imf::FLOAT &&
                                  channel->xSampling == 1 && channel->ySampling == 1;
                if (!fits) {
                    throw std::runtime_error("it has no float channel " + prefix + color);
                }
            }
            insert(image.rgb.data(), kColor, prefix, window.box, buffer);
        }
        file.setFrameBuffer(buffer);
        file.readPixels(window.box.min.y, window.box.max.y);
        for (auto a = file.header().begin(); a != file.header().end(); ++a) {
            const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute());
            if (text != nullptr) layers.attributes[a.name()] = text->value();
        }
        return layers;
    } catch (const std::exception& e) {
        throw Error(Errc::DataLoss, "read image '" + path.string() + "': " + e.what());
    }
}

}  // namespace misbench
