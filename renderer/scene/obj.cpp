#include "renderer/scene/obj.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <limits>
#include <map>

#include "renderer/base/error.h"
#include "renderer/base/files.h"

namespace misbench {
namespace {

// A corner of a face: indices into the file's lists, from 0; absent ones are kNone.
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
using Corner = std::array<std::uint32_t, 3>;  // position, texture coordinate, normal

class ObjReader {
 public:
    explicit ObjReader(const std::filesystem::path& path)
        : file_(path.string()), bytes_(read_file(path)) {}

    std::vector<ObjPart> read() {
        std::string_view rest = bytes_;
        while (!rest.empty()) {
            ++line_;
            const std::size_t end = std::min(rest.find('\n'), rest.size());
            read_line(rest.substr(0, end));
            rest.remove_prefix(std::min(end + 1, rest.size()));
        }
        finish_part();
        return std::move(parts_);
    }

 private:
    [[noreturn]] void fail(const std::string& reason) const {
        throw Error(Errc::InvalidArgument,
                    "read OBJ '" + file_ + "': line " + std::to_string(line_) + ": " + reason);
    }

    // The next word of `text`, "" at its end.
    static std::string_view word(std::string_view& text) {
        text.remove_prefix(std::min(text.find_first_not_of(" \t\r"), text.size()));
        const std::string_view found = text.substr(0, text.find_first_of(" \t\r"));
        text.remove_prefix(found.size());
        return found;
    }

    float number(std::string_view& text) const {
        const std::string_view token = word(text);
        float value = 0;
        const auto [end, status] =
            std::from_chars(token.data(), token.data() + token.size(), value);
        if (status != std::errc() || end != token.data() + token.size()) {
            fail("'" + std::string(token) + "' is not a number");
        }
        return value;
    }
    Vec3 vec3(std::string_view& text) const {
        const float x = number(text);
        const float y = number(text);
        return {x, y, number(text)};
    }

    void read_line(std::string_view text) {
        text = text.substr(0, text.find('#'));
        const std::string_view keyword = word(text);
        if (keyword == "v") {
            positions_.push_back(vec3(text));
        } else if (keyword == "vn") {
            normals_.push_back(vec3(text));
        } else if (keyword == "vt") {
            const float u = number(text);
            uvs_.push_back({u, 1 - number(text)});
        } else if (keyword == "f") {
            read_face(text);
        } else if (keyword == "usemtl") {
            finish_part();
            part_.material = std::string(word(text));
        }
        // Groups, smoothing, lines, points, the .mtl file's name: nothing that we need.
    }

    // One of v, vt, vn of a corner: 1 is the first, -1 the latest of its list.
    std::uint32_t index(std::string_view token, std::size_t size) const {
        std::int64_t value = 0;
        const auto [end, status] =
            std::from_chars(token.data(), token.data() + token.size(), value);
        const bool read = status == std::errc() && end == token.data() + token.size();
        if (value < 0) value += static_cast<std::int64_t>(size) + 1;
        if (!read || value < 1 || value > static_cast<std::int64_t>(size)) {
            fail("face index '" + std::string(token) + "' names none of " + std::to_string(size));
        }
        return static_cast<std::uint32_t>(value - 1);
    }

    Corner corner(std::string_view token) const {
        const std::array sizes = {positions_.size(), uvs_.size(), normals_.size()};
        Corner corner = {kNone, kNone, kNone};
        for (std::size_t i = 0; i < corner.size(); ++i) {
            const std::string_view field = token.substr(0, token.find('/'));
            if (!field.empty() || i == 0) corner[i] = index(field, sizes[i]);
            if (field.size() == token.size()) return corner;
            token.remove_prefix(field.size() + 1);
        }
        fail("a corner has more than three indices");
    }

    void read_face(std::string_view text) {
        std::vector<std::uint32_t> face;
        for (std::string_view token = word(text); !token.empty(); token = word(text)) {
            face.push_back(vertex(corner(token)));
        }
        if (face.size() < 3) fail("a face with fewer than three corners");
        for (std::size_t i = 2; i < face.size(); ++i) {
            part_.mesh.triangles.push_back({face[0], face[i - 1], face[i]});
        }
    }

    // The part's vertex for a corner, made when it is new.
    std::uint32_t vertex(const Corner& corner) {
        Mesh& mesh = part_.mesh;
        const auto [known, is_new] =
            vertices_.try_emplace(corner, static_cast<std::uint32_t>(mesh.positions.size()));
        if (is_new) {
            mesh.positions.push_back(positions_[corner[0]]);
            mesh.uvs.push_back(corner[1] == kNone ? Vec2{} : uvs_[corner[1]]);
            mesh.normals.push_back(corner[2] == kNone ? Vec3{} : normals_[corner[2]]);
            all_have_uvs_ = all_have_uvs_ && corner[1] != kNone;
            all_have_normals_ = all_have_normals_ && corner[2] != kNone;
        }
        return known->second;
    }

    void finish_part() {
        if (!part_.mesh.triangles.empty()) {
            if (!all_have_uvs_) part_.mesh.uvs.clear();
            if (!all_have_normals_) part_.mesh.normals.clear();
            parts_.push_back(std::move(part_));
        }
        part_ = {};
        vertices_.clear();
        all_have_uvs_ = true;
        all_have_normals_ = true;
    }

    std::string file_;
    std::string bytes_;
    std::size_t line_ = 0;
    std::vector<Vec3> positions_;
    std::vector<Vec3> normals_;
    std::vector<Vec2> uvs_;
    std::vector<ObjPart> parts_;
    ObjPart part_;
    std::map<Corner, std::uint32_t> vertices_;
    bool all_have_uvs_ = true;
    bool all_have_normals_ = true;
};

}  // namespace

std::vector<ObjPart> read_obj(const std::filesystem::path& path) { return ObjReader(path).read(); }

}  // namespace misbench
