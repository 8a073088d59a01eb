#include "renderer/scene/obj.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>

#include "renderer/base/error.h"
#include "renderer/base/files.h"

namespace misbench {
namespace {

// A corner of a face: indices into the file's lists, from 0; absent ones are kNone.
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
using Corner = std::array<std::uint32_t, 3>;  // position, texture coordinate, normal

// The corners met so far, each with the index of its vertex: a hash table with linear probing, at
// most half full.
class CornerTable {
 public:
    // The vertex of the corner: the next number for a corner that is new.
    std::uint32_t find_or_add(const Corner& corner) {
        if (2 * (corners_.size() + 1) > slots_.size()) grow();
        std::uint32_t& slot = slot_of(corner);
        if (slot == kNone) {
            slot = static_cast<std::uint32_t>(corners_.size());
            corners_.push_back(corner);
        }
        return slot;
    }

 private:
    std::uint32_t& slot_of(const Corner& corner) {
        std::uint64_t hash = 0;
        for (const std::uint32_t index : corner) hash = (hash ^ index) * 0x9E3779B97F4A7C15ULL;
        const std::size_t mask = slots_.size() - 1;
        std::size_t at = (hash >> 32) & mask;
        while (slots_[at] != kNone && corners_[slots_[at]] != corner) at = (at + 1) & mask;
        return slots_[at];
    }
    void grow() {
        slots_.assign(std::max<std::size_t>(64, 2 * slots_.size()), kNone);
        for (std::uint32_t i = 0; i < corners_.size(); ++i) slot_of(corners_[i]) = i;
    }

    std::vector<std::uint32_t> slots_;  // a power of two of them
    std::vector<Corner> corners_;
};

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

    static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r'; }

    static std::string_view trimmed(std::string_view text) {
        while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
        while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
        return text;
    }

    // The next word of `text`, "" at its end.
    static std::string_view word(std::string_view& text) {
        const auto* const begin = std::find_if_not(text.begin(), text.end(), is_space);
        const auto* const end = std::find_if(begin, text.end(), is_space);
        text.remove_prefix(static_cast<std::size_t>(end - text.begin()));
        return {begin, end};
    }

    float number(std::string_view& text) const {
        const std::string_view token = word(text);
        const char* const last = token.data() + token.size();
        float value = 0;
        auto parsed = std::from_chars(token.data(), last, value);
        if (parsed.ec == std::errc::result_out_of_range) {
            // What is too small for a float is 0.
            double wide = 1;
            parsed = std::from_chars(token.data(), last, wide);
            if (std::abs(wide) >= 1) fail("'" + std::string(token) + "' is too large");
        }
        if (parsed.ec != std::errc() || parsed.ptr != last) {
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
            part_.material = std::string(trimmed(text));
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

    // Fans the polygon out from its first corner.
    void read_face(std::string_view text) {
        std::array<std::uint32_t, 2> fan{};  // first and previous corner
        std::size_t n = 0;
        for (std::string_view token = word(text); !token.empty(); token = word(text), ++n) {
            const std::uint32_t next = vertex(corner(token));
            if (n == 0) fan[0] = next;
            if (n >= 2) part_.mesh.triangles.push_back({fan[0], fan[1], next});
            fan[1] = next;
        }
        if (n < 3) fail("a face with fewer than three corners");
    }

    // The part's vertex for a corner, made when it is new.
    std::uint32_t vertex(const Corner& corner) {
        Mesh& mesh = part_.mesh;
        const std::uint32_t vertex = vertices_.find_or_add(corner);
        if (vertex == mesh.positions.size()) {
            mesh.positions.push_back(positions_[corner[0]]);
            mesh.uvs.push_back(corner[1] == kNone ? Vec2{} : uvs_[corner[1]]);
            mesh.normals.push_back(corner[2] == kNone ? Vec3{} : normals_[corner[2]]);
            some_have_uvs_ = some_have_uvs_ || corner[1] != kNone;
            all_have_normals_ = all_have_normals_ && corner[2] != kNone;
        }
        return vertex;
    }

    void finish_part() {
        if (!part_.mesh.triangles.empty()) {
            if (!some_have_uvs_) part_.mesh.uvs.clear();
            if (!all_have_normals_) part_.mesh.normals.clear();
            parts_.push_back(std::move(part_));
        }
        part_ = {};
        vertices_ = {};
        some_have_uvs_ = false;
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
    CornerTable vertices_;
    bool some_have_uvs_ = false;
    bool all_have_normals_ = true;
};

}  // namespace

std::vector<ObjPart> read_obj(const std::filesystem::path& path) { return ObjReader(path).read(); }

}  // namespace misbench
