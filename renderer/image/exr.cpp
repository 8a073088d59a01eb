#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfVersion.h>

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

// What the file has of what we read.
Channels channels_of(const Imf::ChannelList& list) {
    const auto has = [&list](const char* name) { return list.findChannel(name) != nullptr; };
    const bool alpha = has("A");
    Channels channels;
    if (has("R") && has("G") && has("B")) {
        channels = alpha ? Channels(kColorAndAlpha) : Channels(kColor);
    } else if (has("Y") && !has("RY") && !has("BY")) {
        channels = alpha ? Channels(kGreyAndAlpha) : Channels(kGrey);
    } else {
        std::string found;
        for (auto c = list.begin(); c != list.end(); ++c) found += std::string(" ") + c.name();
        throw std::runtime_error("its channels are" + found + "; known: R G B, or Y, and A");
    }
    for (const char* name : channels) {
        const Imf::Channel& channel = list[name];
        if (channel.xSampling != 1 || channel.ySampling != 1) {
            throw std::runtime_error(std::string("its channel ") + name + " is subsampled");
        }
    }
    return channels;
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

// Its one part, which covers the whole picture. Throws std::runtime_error.
Imath::Box2i checked_window(const Imf::InputFile& file, std::size_t n_bytes) {
    if (Imf::isMultiPart(file.version())) throw std::runtime_error("it has several parts");
    const Imf::Header& header = file.header();
    const Imath::Box2i window = header.dataWindow();
    if (window != header.displayWindow()) {
        throw std::runtime_error("its data window is not its display window");
    }
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
    const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
    check_image_size(width, height);
    if (width * height / kMaxPixelsPerByte > static_cast<std::int64_t>(n_bytes)) {
        throw std::runtime_error("the file is too short for " + std::to_string(width) + " x " +
                                 std::to_string(height) + " pixels");
    }
    return window;
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

Pixels decode_exr(const std::string& bytes) {
    ByteStream stream(bytes);
    Imf::InputFile file(stream, 0);
    const Imath::Box2i window = checked_window(file, bytes.size());
    const Channels channels = channels_of(file.header().channels());
    Pixels pixels{.width = window.max.x - window.min.x + 1,
                  .height = window.max.y - window.min.y + 1,
                  .n_channels = static_cast<int>(channels.size()),
                  .values = {}};
    std::vector<float> values(pixels.n_values());
    Imf::FrameBuffer buffer;
    insert(values.data(), channels, "", window, buffer);
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
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

std::vector<NamedImage> read_exr_layers(const std::filesystem::path& path) {
    const std::string bytes = read_file(path);
    try {
        ByteStream stream(bytes);
        Imf::InputFile file(stream, 0);
        const Imath::Box2i window = checked_window(file, bytes.size());
        const Imf::ChannelList& channels = file.header().channels();
        std::vector<NamedImage> layers;
        for (auto c = channels.begin(); c != channels.end(); ++c) {
            const std::string channel = c.name();
            const std::size_t dot = channel.rfind('.');
            const std::string prefix = dot == std::string::npos ? "" : channel.substr(0, dot + 1);
            if (channel != prefix + "R") continue;
            for (const char* name : kColor) {
                const Imf::Channel* found = channels.findChannel(prefix + name);
                if (found == nullptr || found->xSampling != 1 || found->ySampling != 1) {
                    throw std::runtime_error("its layer '" + prefix + "' is not R G B");
                }
            }
            layers.push_back(
                {prefix.substr(0, prefix.empty() ? 0 : prefix.size() - 1),
                 Image(window.max.x - window.min.x + 1, window.max.y - window.min.y + 1)});
        }
        Imf::FrameBuffer buffer;
        for (NamedImage& layer : layers) {
            insert(layer.image.rgb.data(), kColor, layer.name.empty() ? "" : layer.name + ".",
                   window, buffer);
        }
        file.setFrameBuffer(buffer);
        file.readPixels(window.min.y, window.max.y);
        return layers;
    } catch (const std::exception& e) {
        throw Error(Errc::DataLoss, "read image '" + path.string() + "': " + e.what());
    }
}

}  // namespace misbench
