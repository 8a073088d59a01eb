// The file: meshes one after the other, then the offset of each (8 bytes, 4 in version 3), then
// their number (4 bytes). A mesh: the magic number and the version (2 bytes each), then a zlib
// stream of flags (4 bytes), from version 4 a name that ends with 0, the numbers of vertices and
// of triangles (8 bytes each), positions, normals, uvs, colours, and the triangles' corners. Little
// endian throughout.
#include "renderer/scene/serialized.h"

#include <zlib.h>

#include <array>
#include <bit>
#include <cstring>
#include <limits>

#include "renderer/base/error.h"
#include "renderer/base/files.h"

namespace misbench {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::uint16_t kMagic = 0x041C;

enum Flags : std::uint32_t {
    kHasNormals = 0x0001,
    kHasUvs = 0x0002,
    kHasColors = 0x0008,
    kSinglePrecision = 0x1000,
    kDoublePrecision = 0x2000,
};

// deflate cannot make more of a byte than this.
constexpr std::size_t kMaxInflation = 1032;

class SerializedReader {
 public:
    SerializedReader(const std::filesystem::path& path, std::size_t index)
        : file_(path.string()), bytes_(read_file(path)), index_(index) {}
    ~SerializedReader() {
        if (is_open_) inflateEnd(&stream_);
    }
    SerializedReader(const SerializedReader&) = delete;
    SerializedReader& operator=(const SerializedReader&) = delete;

    Mesh read() {
        open_stream();
        const auto flags = next<std::uint32_t>();
        if (version_ >= 4) {
            while (next<char>() != 0) {
            }
        }
        const auto n_vertices = next<std::uint64_t>();
        const auto n_triangles = next<std::uint64_t>();
        const bool is_double = (flags & kDoublePrecision) != 0;
        if (is_double == ((flags & kSinglePrecision) != 0)) fail("neither float nor double");
        check_counts(n_vertices, n_triangles, flags);

        Mesh mesh;
        const auto vec3s = [&](std::vector<Vec3>& to) {
            for (auto& v : to) v = {number(is_double), number(is_double), number(is_double)};
        };
        mesh.positions.resize(n_vertices);
        vec3s(mesh.positions);
        if ((flags & kHasNormals) != 0) {
            mesh.normals.resize(n_vertices);
            vec3s(mesh.normals);
        }
        if ((flags & kHasUvs) != 0) {
            mesh.uvs.resize(n_vertices);
            for (Vec2& uv : mesh.uvs) uv = {number(is_double), number(is_double)};
        }
        if ((flags & kHasColors) != 0) {
            for (std::uint64_t i = 0; i < 3 * n_vertices; ++i) number(is_double);
        }
        mesh.triangles.resize(n_triangles);
        for (TriangleIndices& triangle : mesh.triangles) {
            for (std::uint32_t& corner : triangle) {
                corner = next<std::uint32_t>();
                if (corner >= n_vertices) {
                    fail("a triangle names vertex " + std::to_string(corner) + " of " +
                         std::to_string(n_vertices));
                }
            }
        }
        return mesh;
    }

 private:
    [[noreturn]] void fail(const std::string& reason) const {
        throw Error(Errc::InvalidArgument, "read serialized '" + file_ + "': mesh " +
                                               std::to_string(index_) + ": " + reason);
    }

    template <class T>
    T at(std::size_t offset) const {
        if (offset > bytes_.size() || bytes_.size() - offset < sizeof(T)) {
            fail("the file is too short");
        }
        T value;
        std::memcpy(&value, bytes_.data() + offset, sizeof(T));
        return value;
    }

    // The bytes of this mesh's stream, by the table at the end of the file.
    void open_stream() {
        if (at<std::uint16_t>(0) != kMagic) fail("not a serialized mesh");
        version_ = at<std::uint16_t>(2);
        if (version_ != 3 && version_ != 4) {
            fail("version " + std::to_string(version_) + " is not supported; known: 3 4");
        }
        const std::size_t width = version_ == 4 ? 8 : 4;
        const std::size_t count_at = std::max<std::size_t>(bytes_.size(), 4) - 4;
        const std::size_t n_meshes = at<std::uint32_t>(count_at);
        if (index_ >= n_meshes) fail("the file has " + std::to_string(n_meshes) + " meshes");
        if (n_meshes > count_at / width) fail("the file is too short for its table");
        const auto offset_of = [&](std::size_t i) -> std::size_t {
            const std::size_t entry = count_at - (n_meshes - i) * width;
            if (i == n_meshes) return count_at - n_meshes * width;
            return width == 8 ? at<std::uint64_t>(entry) : at<std::uint32_t>(entry);
        };
        const std::size_t begin = offset_of(index_);
        const std::size_t end = offset_of(index_ + 1);
        if (begin > end || end > bytes_.size() || end - begin < 4 ||
            at<std::uint16_t>(begin) != kMagic) {
            fail("the file's table names a place that holds no mesh");
        }
        n_compressed_ = end - begin - 4;
        if (n_compressed_ > std::numeric_limits<uInt>::max()) fail("larger than 4 GB");
        stream_.next_in = reinterpret_cast<Bytef*>(bytes_.data() + begin + 4);
        stream_.avail_in = static_cast<uInt>(n_compressed_);
        if (inflateInit(&stream_) != Z_OK) fail("zlib does not start");
        is_open_ = true;
    }

    // Memory is taken for what the compressed bytes can hold, whatever the file claims.
    void check_counts(std::uint64_t n_vertices, std::uint64_t n_triangles,
                      std::uint32_t flags) const {
        const std::size_t most = n_compressed_ * kMaxInflation;
        const std::size_t size = (flags & kDoublePrecision) != 0 ? 8 : 4;
        const std::size_t numbers = 3 + ((flags & kHasNormals) != 0 ? 3U : 0U) +
                                    ((flags & kHasUvs) != 0 ? 2U : 0U) +
                                    ((flags & kHasColors) != 0 ? 3U : 0U);
        if (n_vertices > most / (size * numbers) || n_triangles > most / 12 ||
            n_vertices > std::numeric_limits<std::uint32_t>::max()) {
            fail("claims " + std::to_string(n_vertices) + " vertices and " +
                 std::to_string(n_triangles) + " triangles, more than its bytes can hold");
        }
    }

    template <class T>
    T next() {
        if (n_used_ + sizeof(T) > n_ready_) refill();
        if (n_used_ + sizeof(T) > n_ready_) fail("the data end too early");
        T value;
        std::memcpy(&value, buffer_.data() + n_used_, sizeof(T));
        n_used_ += sizeof(T);
        return value;
    }
    float number(bool is_double) {
        return is_double ? static_cast<float>(next<double>()) : next<float>();
    }

    void refill() {
        const std::size_t n_left = n_ready_ - n_used_;
        std::memmove(buffer_.data(), buffer_.data() + n_used_, n_left);
        stream_.next_out = buffer_.data() + n_left;
        stream_.avail_out = static_cast<uInt>(buffer_.size() - n_left);
        const int status = inflate(&stream_, Z_NO_FLUSH);
        if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR) {
            fail("the compressed data are damaged");
        }
        n_used_ = 0;
        n_ready_ = buffer_.size() - stream_.avail_out;
    }

    std::string file_;
    std::string bytes_;
    std::size_t index_;
    std::uint16_t version_ = 0;
    std::size_t n_compressed_ = 0;
    z_stream stream_{};
    bool is_open_ = false;
    std::array<unsigned char, 1 << 16> buffer_{};
    std::size_t n_ready_ = 0;
    std::size_t n_used_ = 0;
};

}  // namespace

Mesh read_serialized(const std::filesystem::path& path, std::size_t index) {
    return SerializedReader(path, index).read();
}

}  // namespace misbench
