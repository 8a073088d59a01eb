#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>

#include <array>
#include <cstring>

#include "renderer/base/error.h"
#include "renderer/base/files.h"
#include "renderer/image/image.h"

namespace misbench {
namespace {

constexpr std::array kChannels = {"R", "G", "B"};
constexpr std::size_t kPixelBytes = 3 * sizeof(float);

Imf::FrameBuffer frame_buffer(float* rgb, int width) {
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < kChannels.size(); ++c) {
        buffer.insert(kChannels[c],
                      Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(rgb + c), kPixelBytes,
                                 kPixelBytes * static_cast<std::size_t>(width)));
    }
    return buffer;
}

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

}  // namespace

void write_exr(const std::filesystem::path& path, const Image& image,
               const std::map<std::string, std::string>& attributes) {
    MemoryStream stream;
    try {
        Imf::Header header(image.width, image.height);
        header.compression() = Imf::NO_COMPRESSION;
        for (const char* channel : kChannels) {
            header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
        }
        for (const auto& [name, value] : attributes) {
            header.insert(name, Imf::StringAttribute(value));
        }
        Imf::OutputFile file(stream, header, 0);
        // The writer only reads from the buffer; its interface is not const-correct.
        file.setFrameBuffer(frame_buffer(const_cast<float*>(image.rgb.data()), image.width));
        file.writePixels(image.height);
    } catch (const std::exception& e) {
        throw Error(Errc::DataLoss, "write image '" + path.string() + "': " + e.what());
    }
    write_file_durably(path, stream.bytes());
}

Image read_exr(const std::filesystem::path& path) {
    if (!std::filesystem::exists(path)) {
        throw Error(Errc::NotFound, "read image '" + path.string() + "': no such file");
    }
    try {
        Imf::InputFile file(path.c_str(), 0);
        const Imath::Box2i window = file.header().dataWindow();
        if (window.min != Imath::V2i(0, 0)) {
            throw std::runtime_error("its data window does not start at (0, 0)");
        }
        for (const char* channel : kChannels) {
            if (file.header().channels().findChannel(channel) == nullptr) {
                throw std::runtime_error(std::string("it has no channel ") + channel);
            }
        }
        Image image(window.max.x + 1, window.max.y + 1);
        file.setFrameBuffer(frame_buffer(image.rgb.data(), image.width));
        file.readPixels(0, image.height - 1);
        return image;
    } catch (const std::exception& e) {
        throw Error(Errc::DataLoss, "read image '" + path.string() + "': " + e.what());
    }
}

}  // namespace misbench
