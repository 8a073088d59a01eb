#include "renderer/scene/ply.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <optional>
#include <sstream>

#include "renderer/base/error.h"
#include "renderer/base/files.h"

namespace misbench {
namespace {

static_assert(std::endian::native == std::endian::little);

enum class Encoding { Ascii, LittleEndian, BigEndian };
enum class Scalar { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float32, Float64 };

struct ScalarName {
    std::string_view name;
    std::string_view sized_name;
    Scalar type;
    std::size_t bytes;
};
constexpr std::array kScalars{
    ScalarName{"char", "int8", Scalar::Int8, 1},
    ScalarName{"uchar", "uint8", Scalar::Uint8, 1},
    ScalarName{"short", "int16", Scalar::Int16, 2},
    ScalarName{"ushort", "uint16", Scalar::Uint16, 2},
    ScalarName{"int", "int32", Scalar::Int32, 4},
    ScalarName{"uint", "uint32", Scalar::Uint32, 4},
    ScalarName{"float", "float32", Scalar::Float32, 4},
    ScalarName{"double", "float64", Scalar::Float64, 8},
};

struct Property {
    std::string name;
    Scalar type;
    std::optional<Scalar> count_type;  // of a list
};

struct Element {
    std::string name;
    std::size_t count = 0;
    std::vector<Property> properties;
};

// Walks the bytes of a PLY file: lines of the header, then values of the body.
class PlyBytes {
 public:
    PlyBytes(std::string_view bytes, std::string file) : bytes_(bytes), file_(std::move(file)) {}

    [[noreturn]] void fail(const std::string& reason) const {
        throw Error(Errc::InvalidArgument,
                    "read PLY '" + file_ + "': byte " + std::to_string(at_) + ": " + reason);
    }

    // The next line without its end, LF or CRLF.
    std::string_view line() {
        const std::size_t end = bytes_.find('\n', at_);
        if (end == std::string_view::npos) fail("the header does not end");
        std::string_view text = bytes_.substr(at_, end - at_);
        at_ = end + 1;
        if (text.ends_with('\r')) text.remove_suffix(1);
        return text;
    }

    double value(Scalar type) { return encoding == Encoding::Ascii ? text_value() : binary(type); }
    std::size_t bytes_left() const { return bytes_.size() - at_; }
    // The next n bytes of a binary body.
    const char* take(std::size_t n) {
        if (bytes_left() < n) fail("the file ends in the middle of its data");
        const char* const taken = bytes_.data() + at_;
        at_ += n;
        return taken;
    }

    Encoding encoding = Encoding::Ascii;

 private:
    template <class T>
    double binary_as() {
        std::array<char, sizeof(T)> raw;
        std::memcpy(raw.data(), take(sizeof(T)), sizeof(T));
        if (encoding == Encoding::BigEndian) std::reverse(raw.begin(), raw.end());
        return static_cast<double>(std::bit_cast<T>(raw));
    }

    double binary(Scalar type) {
        switch (type) {
            case Scalar::Int8:
                return binary_as<std::int8_t>();
            case Scalar::Uint8:
                return binary_as<std::uint8_t>();
            case Scalar::Int16:
                return binary_as<std::int16_t>();
            case Scalar::Uint16:
                return binary_as<std::uint16_t>();
            case Scalar::Int32:
                return binary_as<std::int32_t>();
            case Scalar::Uint32:
                return binary_as<std::uint32_t>();
            case Scalar::Float32:
                return binary_as<float>();
            case Scalar::Float64:
                break;
        }
        return binary_as<double>();
    }

    double text_value() {
        at_ = std::min(bytes_.find_first_not_of(" \t\r\n", at_), bytes_.size());
        double value = 0;
        const auto [end, status] =
            std::from_chars(bytes_.data() + at_, bytes_.data() + bytes_.size(), value);
        if (status != std::errc()) {
            fail(bytes_left() == 0 ? "the file ends in the middle of its data" : "not a number");
        }
        at_ = static_cast<std::size_t>(end - bytes_.data());
        return value;
    }

    std::string_view bytes_;
    std::string file_;
    std::size_t at_ = 0;
};

const ScalarName& scalar_row(Scalar type) { return kScalars[static_cast<std::size_t>(type)]; }

bool is_integer(Scalar type) { return type != Scalar::Float32 && type != Scalar::Float64; }

const ScalarName& scalar_named(const std::string& name, const PlyBytes& in) {
    const auto* row = std::find_if(kScalars.begin(), kScalars.end(), [&name](const ScalarName& s) {
        return s.name == name || s.sized_name == name;
    });
    if (row == kScalars.end()) in.fail("unknown type '" + name + "'");
    return *row;
}

Encoding encoding_named(const std::string& name, const PlyBytes& in) {
    if (name == "ascii") return Encoding::Ascii;
    if (name == "binary_little_endian") return Encoding::LittleEndian;
    if (name == "binary_big_endian") return Encoding::BigEndian;
    in.fail("unknown format '" + name + "'; known: ascii binary_little_endian binary_big_endian");
}

// A file must not make us allocate more than it could fill: every row takes a byte or more.
std::size_t checked_count(double count, const PlyBytes& in) {
    if (!(count >= 0) || count > static_cast<double>(in.bytes_left())) {
        in.fail("a count is larger than the file");
    }
    return static_cast<std::size_t>(count);
}

std::vector<Element> read_header(PlyBytes& in) {
    if (in.line() != "ply") in.fail("the first line is not 'ply'");
    std::vector<Element> elements;
    while (true) {
        std::istringstream words{std::string(in.line())};
        std::string word;
        words >> word;
        if (word == "end_header") return elements;
        if (word == "format") {
            words >> word;
            in.encoding = encoding_named(word, in);
        } else if (word == "element") {
            Element element;
            double count = -1;
            words >> element.name >> count;
            element.count = checked_count(count, in);
            elements.push_back(std::move(element));
        } else if (word == "property") {
            if (elements.empty()) in.fail("a property without an element");
            Property property{};
            words >> word;
            if (word == "list") {
                words >> word;
                property.count_type = scalar_named(word, in).type;
                if (!is_integer(*property.count_type)) in.fail("a list's length of type " + word);
                words >> word;
            }
            property.type = scalar_named(word, in).type;
            words >> property.name;
            elements.back().properties.push_back(std::move(property));
        } else if (word != "comment" && word != "obj_info" && !word.empty()) {
            in.fail("unknown header line '" + word + "'");
        }
    }
}

void skip(const Property& property, PlyBytes& in) {
    const std::size_t n =
        property.count_type ? checked_count(in.value(*property.count_type), in) : 1;
    for (std::size_t i = 0; i < n; ++i) in.value(property.type);
}

// The least that a row of the element takes in the file.
std::size_t min_row_bytes(const Element& element, Encoding encoding) {
    std::size_t n = 0;
    for (const Property& property : element.properties) {
        // A value of text is a digit and what parts it from the next one.
        n += encoding == Encoding::Ascii
                 ? 2
                 : scalar_row(property.count_type.value_or(property.type)).bytes;
    }
    return std::max<std::size_t>(n, 1);
}

// Refuses more rows than the rest of the file can hold, before memory is made for them. The last
// value of a text may stand without a space behind it.
void check_rows(const Element& element, const PlyBytes& in) {
    if (element.count > in.bytes_left() / min_row_bytes(element, in.encoding) + 1) {
        in.fail("a count is larger than the file");
    }
}

// The floats of a vertex that we read: 0-2 position, 3-5 normal, 6-7 texture coordinates.
constexpr std::size_t kVertexFloats = 8;
using VertexFloats = std::array<float, kVertexFloats>;

// Which of them a property fills.
std::optional<std::size_t> vertex_slot(const Property& property) {
    constexpr std::array<std::string_view, 10> kNames = {"x",  "y", "z", "nx", "ny",
                                                         "nz", "u", "v", "s",  "t"};
    const auto* found = std::find(kNames.begin(), kNames.end(), property.name);
    if (found == kNames.end() || property.count_type) return std::nullopt;
    const auto slot = static_cast<std::size_t>(found - kNames.begin());
    return slot < kVertexFloats ? slot : slot - 2;
}

// Reads vertices one by one: by their place in the row where rows have one size and our floats
// need no conversion, else value by value.
class VertexReader {
 public:
    VertexReader(const Element& element, PlyBytes& in) : element_(element), in_(in) {
        is_plain_ = in.encoding == Encoding::LittleEndian;
        for (const Property& property : element.properties) {
            const auto slot = vertex_slot(property);
            slots_.push_back(slot);
            if (slot) {
                present_[*slot] = true;
                offsets_[*slot] = row_bytes_;
            }
            is_plain_ =
                is_plain_ && !property.count_type && (!slot || property.type == Scalar::Float32);
            row_bytes_ += scalar_row(property.type).bytes;
        }
    }

    bool has(std::size_t first, std::size_t n) const {
        return std::all_of(present_.begin() + first, present_.begin() + first + n,
                           [](bool present) { return present; });
    }

    VertexFloats next() { return is_plain_ ? by_place() : by_value(); }

 private:
    VertexFloats by_place() {
        VertexFloats v{};
        const char* const row = in_.take(row_bytes_);
        for (std::size_t slot = 0; slot < kVertexFloats; ++slot) {
            if (present_[slot]) std::memcpy(&v[slot], row + offsets_[slot], sizeof(float));
        }
        return v;
    }

    VertexFloats by_value() {
        VertexFloats v{};
        for (std::size_t p = 0; p < slots_.size(); ++p) {
            if (slots_[p]) {
                v[*slots_[p]] = static_cast<float>(in_.value(element_.properties[p].type));
            } else {
                skip(element_.properties[p], in_);
            }
        }
        return v;
    }

    const Element& element_;
    PlyBytes& in_;
    std::vector<std::optional<std::size_t>> slots_;  // parallel to the properties
    std::array<bool, kVertexFloats> present_{};
    std::array<std::size_t, kVertexFloats> offsets_{};
    std::size_t row_bytes_ = 0;
    bool is_plain_ = false;
};

void read_vertices(const Element& element, PlyBytes& in, Mesh& mesh) {
    VertexReader reader(element, in);
    if (!reader.has(0, 3)) in.fail("vertices without x y z");
    const bool has_normals = reader.has(3, 3);
    const bool has_uvs = reader.has(6, 2);
    mesh.positions.reserve(element.count);
    if (has_normals) mesh.normals.reserve(element.count);
    if (has_uvs) mesh.uvs.reserve(element.count);
    for (std::size_t i = 0; i < element.count; ++i) {
        const VertexFloats v = reader.next();
        mesh.positions.push_back({v[0], v[1], v[2]});
        if (has_normals) mesh.normals.push_back({v[3], v[4], v[5]});
        if (has_uvs) mesh.uvs.push_back({v[6], v[7]});
    }
}

void read_polygon(const Property& property, PlyBytes& in, Mesh& mesh) {
    const std::size_t n = checked_count(in.value(*property.count_type), in);
    std::array<std::uint32_t, 2> fan{};  // first and previous corner
    for (std::size_t i = 0; i < n; ++i) {
        const double index = in.value(property.type);
        if (!(index >= 0 && index < static_cast<double>(mesh.positions.size()))) {
            in.fail("a face names vertex " + std::to_string(index) + " of " +
                    std::to_string(mesh.positions.size()));
        }
        const auto corner = static_cast<std::uint32_t>(index);
        if (i == 0) fan[0] = corner;
        if (i >= 2) mesh.triangles.push_back({fan[0], fan[1], corner});
        fan[1] = corner;
    }
}

bool is_corner_list(const Property& property) {
    return property.count_type && is_integer(property.type) &&
           (property.name == "vertex_index" || property.name == "vertex_indices");
}

void read_faces(const Element& element, PlyBytes& in, Mesh& mesh) {
    if (std::none_of(element.properties.begin(), element.properties.end(), is_corner_list)) {
        in.fail("faces without an integer list vertex_index or vertex_indices");
    }
    mesh.triangles.reserve(element.count);
    for (std::size_t i = 0; i < element.count; ++i) {
        for (const Property& property : element.properties) {
            if (is_corner_list(property)) {
                read_polygon(property, in, mesh);
            } else {
                skip(property, in);
            }
        }
    }
}

void skip_rows(const Element& element, PlyBytes& in) {
    for (std::size_t i = 0; i < element.count; ++i) {
        for (const Property& property : element.properties) skip(property, in);
    }
}

}  // namespace

Mesh read_ply(const std::filesystem::path& path) {
    const std::string bytes = read_file(path);
    PlyBytes in(bytes, path.string());
    const std::vector<Element> elements = read_header(in);
    Mesh mesh;
    int n_vertex_elements = 0;
    int n_face_elements = 0;
    for (const Element& element : elements) {
        check_rows(element, in);
        if (element.name == "vertex") {
            if (++n_vertex_elements > 1) in.fail("two elements are named 'vertex'");
            read_vertices(element, in, mesh);
        } else if (element.name == "face") {
            ++n_face_elements;
            read_faces(element, in, mesh);
        } else {
            skip_rows(element, in);
        }
    }
    if (n_face_elements == 0) in.fail("no element is named 'face'");
    return mesh;
}

}  // namespace misbench
