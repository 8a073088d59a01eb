// PNG, JPEG, TGA, BMP and HDR through stb_image.
#include <algorithm>
#include <cstring>
#include <memory>
#include <stdexcept>

#include "renderer/image/decode.h"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_ONLY_TGA
#define STBI_ONLY_BMP
#define STBI_ONLY_HDR
#define STBI_NO_STDIO
#include <stb/stb_image.h>

namespace misbench {
namespace {

// Hands a file's bytes to stb and, after their end, zeros without end. stb itself makes something
// up where a file ends too early, and calls that an image: what counts is how far it read.
class Source {
 public:
    explicit Source(const std::string& bytes) : bytes_(bytes) {
        stbi_io_callbacks callbacks{read, skip, is_at_end};
        stbi__start_callbacks(&context_, &callbacks, this);
    }
    Source(const Source&) = delete;
    Source& operator=(const Source&) = delete;

    stbi__context* context() { return &context_; }
    bool has_read_past_the_end() const {
        // Bytes in stb's buffer were handed out, but not read.
        const auto unread = static_cast<std::size_t>(context_.img_buffer_end - context_.img_buffer);
        return at_ - unread > bytes_.size();
    }

 private:
    static int read(void* self, char* target, int size) {
        auto& source = *static_cast<Source*>(self);
        const auto wanted = static_cast<std::size_t>(size);
        const std::size_t begin = std::min(source.at_, source.bytes_.size());
        const std::size_t n = std::min(wanted, source.bytes_.size() - begin);
        std::memcpy(target, source.bytes_.data() + begin, n);
        std::memset(target + n, 0, wanted - n);
        source.at_ += wanted;
        return size;
    }
    static void skip(void* self, int size) {
        static_cast<Source*>(self)->at_ += static_cast<std::size_t>(size);
    }
    static int is_at_end(void* self) {
        const auto& source = *static_cast<Source*>(self);
        return source.at_ >= source.bytes_.size() ? 1 : 0;
    }

    const std::string& bytes_;
    std::size_t at_ = 0;
    stbi__context context_{};
};

// stb writes beyond its arrays where a Huffman table of a JPEG file has more codes than bytes can
// name. Walks the segments of a JPEG file as stb does, and refuses such a table.
void check_jpeg_tables(const std::string& bytes) {
    const auto byte = [&bytes](std::size_t i) {
        return i < bytes.size() ? static_cast<unsigned char>(bytes[i]) : 0U;
    };
    std::size_t at = std::min(bytes.find_first_not_of('\xff'), bytes.size());
    if (at == 0 || byte(at) != 0xd8) return;  // not a JPEG file
    while ((at = bytes.find('\xff', at)) != std::string::npos) {
        at = std::min(bytes.find_first_not_of('\xff', at), bytes.size());
        const unsigned marker = byte(at++);
        if (marker == 0xd9) return;  // the image's end
        // An escaped byte of the data, and markers without a segment.
        if (marker <= 0x01 || (marker >= 0xd0 && marker <= 0xd8)) continue;
        const std::size_t end = at + std::max(2U, 256 * byte(at) + byte(at + 1));
        if (marker == 0xc4) {
            for (std::size_t table = at + 2; table < end;) {
                unsigned n_codes = 0;
                for (std::size_t length = 1; length <= 16; ++length)
                    n_codes += byte(table + length);
                if (n_codes > 256) {
                    throw std::runtime_error("a Huffman table has " + std::to_string(n_codes) +
                                             " codes, more than 256");
                }
                table += 17 + n_codes;
            }
        }
        at = end;
    }
}

struct Free {
    void operator()(void* memory) const { stbi_image_free(memory); }
};

// Calls load(context, &width, &height, &n_channels, 0), one of stb's decoders.
template <class T, class Load>
Pixels load(const std::string& bytes, Load load) {
    Source source(bytes);
    Pixels pixels;
    const std::unique_ptr<void, Free> memory(
        load(source.context(), &pixels.width, &pixels.height, &pixels.n_channels, 0));
    if (memory == nullptr) throw std::runtime_error(stbi_failure_reason());
    if (source.has_read_past_the_end()) {
        throw std::runtime_error("the file ends in the middle of its data");
    }
    const T* values = static_cast<const T*>(memory.get());
    pixels.values = std::vector<T>(values, values + pixels.n_values());
    return pixels;
}

}  // namespace

Pixels decode_with_stb(const std::string& bytes) {
    check_jpeg_tables(bytes);
    int width = 0;
    int height = 0;
    int n_channels = 0;
    if (stbi__info_main(Source(bytes).context(), &width, &height, &n_channels) == 0) {
        throw std::runtime_error(
            "not a PNG, JPEG, TGA, BMP, HDR, PFM or EXR file, or a broken one");
    }
    check_image_size(width, height);
    if (stbi__hdr_test(Source(bytes).context()) != 0) {
        return load<float>(bytes, stbi__loadf_main);
    }
    if (stbi__is_16_main(Source(bytes).context()) != 0) {
        return load<std::uint16_t>(bytes, stbi__load_and_postprocess_16bit);
    }
    return load<std::uint8_t>(bytes, stbi__load_and_postprocess_8bit);
}

}  // namespace misbench
