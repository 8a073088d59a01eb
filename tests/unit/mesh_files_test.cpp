#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>

#include "renderer/base/error.h"
#include "renderer/scene/obj.h"
#include "renderer/scene/ply.h"
#include "tests/support/temporary_folder.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

class MeshFile : public testing::Test {
 protected:
    // The messages of the errors that reading a text gives.
    std::string ply_error(std::string_view text) const {
        return error_of([&] { read_ply(folder_.write("m.ply", text)); });
    }
    std::string obj_error(std::string_view text) const {
        return error_of([&] { read_obj(folder_.write("m.obj", text)); });
    }
    TemporaryFolder folder_;

 private:
    static std::string error_of(const auto& action) {
        try {
            action();
        } catch (const Error& e) {
            return e.what();
        }
        return "no error";
    }
};

// One square, as two triangles or one polygon, in each of the three encodings.
constexpr std::array<std::array<float, 5>, 4> kSquare{
    {{0, 0, 0, 0, 0}, {1, 0, 0, 1, 0}, {1, 1, 0, 1, 1}, {0, 1, 0, 0, 1}}};

std::string ply_header(const std::string& format) {
    return "ply\r\nformat " + format +
           " 1.0\r\ncomment a square\r\nelement vertex 4\r\nproperty float x\r\nproperty float "
           "y\r\n"
           "property float z\r\nproperty float s\r\nproperty float t\r\nelement face 1\r\n"
           "property list uchar int vertex_indices\r\nend_header\r\n";
}

template <class T>
void append(std::string& bytes, T value, bool big) {
    auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if (big) std::reverse(raw.begin(), raw.end());
    bytes.append(raw.data(), raw.size());
}

std::string binary_ply(bool big) {
    std::string bytes = ply_header(big ? "binary_big_endian" : "binary_little_endian");
    for (const auto& vertex : kSquare) {
        for (const float value : vertex) append(bytes, value, big);
    }
    bytes += '\4';
    for (std::int32_t i = 0; i < 4; ++i) append(bytes, i, big);
    return bytes;
}

TEST_F(MeshFile, ReadsPlyInAllThreeEncodings) {
    std::string ascii = ply_header("ascii");
    for (const auto& vertex : kSquare) {
        for (const float value : vertex) ascii += std::to_string(value) + " ";
    }
    ascii += "\n4 0 1 2 3\n";
    for (const std::string& bytes : {ascii, binary_ply(false), binary_ply(true)}) {
        const Mesh mesh = read_ply(folder_.write("m.ply", bytes));
        ASSERT_EQ(mesh.positions.size(), 4U);
        EXPECT_EQ(mesh.positions[2], (Vec3{1, 1, 0}));
        EXPECT_EQ(mesh.uvs[3], (Vec2{0, 1}));
        EXPECT_TRUE(mesh.normals.empty());
        EXPECT_THAT(mesh.triangles,
                    ElementsAre(TriangleIndices{0, 1, 2}, TriangleIndices{0, 2, 3}));
    }
}

TEST_F(MeshFile, RefusesEveryPlyThatIsCutShort) {
    const std::string whole = binary_ply(false);
    for (std::size_t size = 0; size < whole.size(); ++size) {
        const fs::path file = folder_.write("m.ply", whole.substr(0, size));
        EXPECT_THAT([&] { read_ply(file); }, ThrowsMessage<Error>(HasSubstr("m.ply': byte ")))
            << size;
    }
}

TEST_F(MeshFile, RefusesAPlyThatPromisesMoreThanItHolds) {
    std::string bytes = binary_ply(false);
    bytes.replace(bytes.find("vertex 4"), 8, "vertex 4000000000000");
    EXPECT_THAT([&] { read_ply(folder_.write("m.ply", bytes)); },
                ThrowsMessage<Error>(HasSubstr("a count is larger than the file")));
    std::string bad_index = binary_ply(false);
    bad_index[bad_index.size() - 4] = 9;
    EXPECT_THAT([&] { read_ply(folder_.write("m.ply", bad_index)); },
                ThrowsMessage<Error>(HasSubstr("a face names vertex 9")));
}

TEST_F(MeshFile, ReadsObjPartsByMaterialWithFansAndTurnedV) {
    const auto parts =
        read_obj(folder_.write("m.obj",
                               "mtllib missing.mtl\n# comment\nv 0 0 0\nv 1 0 0\nv 1 1 0\n"
                               "v 0 1 0\nvt 0 0.25\nvn 0 0 1\no a\nusemtl one\ns off\n"
                               "f 1/1/1 2/1/1 3/1/1 4/1/1\nl 1 2\nusemtl two.x\n"
                               "f -4//1 -3//1 -2//1\r\n"));
    ASSERT_EQ(parts.size(), 2U);
    EXPECT_EQ(parts[0].material, "one");
    EXPECT_THAT(parts[0].mesh.triangles,
                ElementsAre(TriangleIndices{0, 1, 2}, TriangleIndices{0, 2, 3}));
    EXPECT_EQ(parts[0].mesh.uvs[0], (Vec2{0, 0.75F}));
    EXPECT_EQ(parts[1].material, "two.x");
    EXPECT_TRUE(parts[1].mesh.uvs.empty());
    EXPECT_EQ(parts[1].mesh.positions[2], (Vec3{1, 1, 0}));
}

TEST_F(MeshFile, NamesTheLineOfABrokenObj) {
    EXPECT_THAT(obj_error("v 0 0 0\nv 1 x 0\n"), HasSubstr("line 2: 'x' is not a number"));
    EXPECT_THAT(obj_error("v 0 0\n"), HasSubstr("line 1: '' is not a number"));
    EXPECT_THAT(obj_error("v 0 0 1e39\n"), HasSubstr("line 1: '1e39' is too large"));
    EXPECT_THAT(obj_error("v 0 0 0\nf 1 2 3\n"),
                HasSubstr("line 2: face index '2' names none of 1"));
    EXPECT_THAT(obj_error("v 0 0 0\nf 1 -2 1\n"), HasSubstr("face index '-2' names none of 1"));
    EXPECT_THAT(obj_error("v 0 0 0\nf 0 1 1\n"), HasSubstr("face index '0' names none of 1"));
    EXPECT_THAT(obj_error("v 0 0 0\nf 1 1\n"), HasSubstr("fewer than three corners"));
    EXPECT_THAT(obj_error("v 0 0 0\nf 1///1 1 1\n"), HasSubstr("more than three indices"));
}

TEST_F(MeshFile, ReadsObjCornersOfEveryForm) {
    const auto parts = read_obj(folder_.write(
        "m.obj",
        "o a\ng b c\nusemtl m\ns 1\nv 0 0 0 1.0\nv 1 0 0\nv 0 1 1e-60\nvt 0.5 0.25 0\n"
        "vn 0 0 1\nf 1 2 3\nf 1/1 2/1 3/1\nf 1//1 2//1 3//1\nf 1/1/1 2/1/-1 3/-1/1\n"));
    ASSERT_EQ(parts.size(), 1U);
    const Mesh& mesh = parts[0].mesh;
    // Four forms of each of three positions: a vertex each.
    ASSERT_EQ(mesh.positions.size(), 12U);
    EXPECT_EQ(mesh.positions[2], (Vec3{0, 1, 0}));
    EXPECT_EQ(mesh.uvs[0], Vec2{});
    EXPECT_EQ(mesh.uvs[3], (Vec2{0.5F, 0.75F}));
    // Some corners have no normal, so that the part has none.
    EXPECT_TRUE(mesh.normals.empty());
}

TEST_F(MeshFile, ReadsAnObjMaterialNameWithSpaces) {
    const auto parts =
        read_obj(folder_.write("m.obj", "v 0 0 0\nusemtl \tDots Stroke \r\nf 1 1 1\n"));
    ASSERT_EQ(parts.size(), 1U);
    EXPECT_EQ(parts[0].material, "Dots Stroke");
}

TEST_F(MeshFile, GivesEqualObjCornersOneVertex) {
    constexpr std::uint32_t kN = 40;
    std::string text = "usemtl m\n";
    for (std::uint32_t i = 1; i <= kN; ++i) {
        text += "v " + std::to_string(i) + " 0 0\nvt " + std::to_string(i) + " 0\n";
    }
    for (int pass = 0; pass < 2; ++pass) {
        for (std::uint32_t i = 1; i <= kN; ++i) {
            for (std::uint32_t k = 1; k <= kN; ++k) {
                text += "f " + std::to_string(i) + "/" + std::to_string(k) + " 1/1 1/1\n";
            }
        }
    }
    const auto parts = read_obj(folder_.write("m.obj", text));
    const Mesh& mesh = parts[0].mesh;
    EXPECT_EQ(mesh.positions.size(), std::size_t{kN * kN});
    ASSERT_EQ(mesh.triangles.size(), std::size_t{2 * kN * kN});
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const std::uint32_t vertex = mesh.triangles[i][0];
        ASSERT_EQ(mesh.positions[vertex].x, static_cast<float>(1 + i / kN % kN));
        ASSERT_EQ(mesh.uvs[vertex].x, static_cast<float>(1 + i % kN));
    }
}

// The floats of a vertex are found wherever the row has them, whatever lies between.
TEST_F(MeshFile, ReadsPlyRowsWithOtherPropertiesInBetween) {
    for (const bool big : {false, true}) {
        for (const bool doubles : {false, true}) {
            const std::string type = doubles ? "double" : "float";
            std::string bytes = "ply\nformat binary_" + std::string(big ? "big" : "little") +
                                "_endian 1.0\nelement vertex 3\nproperty uchar red\nproperty " +
                                type +
                                " z\nproperty float y\nproperty short w\nproperty float x\n"
                                "element face 1\nproperty uchar flags\n"
                                "property list uint ushort vertex_index\nend_header\n";
            for (float i = 0; i < 3; ++i) {
                bytes += 'r';
                if (doubles) {
                    append(bytes, double{i}, big);
                } else {
                    append(bytes, i, big);
                }
                append(bytes, 10 * i, big);
                append(bytes, std::int16_t{7}, big);
                append(bytes, 100 * i, big);
            }
            bytes += 'f';
            append(bytes, std::uint32_t{3}, big);
            for (std::uint16_t i = 0; i < 3; ++i) append(bytes, i, big);
            const Mesh mesh = read_ply(folder_.write("m.ply", bytes));
            ASSERT_EQ(mesh.positions.size(), 3U);
            EXPECT_EQ(mesh.positions[2], (Vec3{200, 20, 2})) << big << doubles;
            EXPECT_THAT(mesh.triangles, ElementsAre(TriangleIndices{0, 1, 2}));
        }
    }
}

TEST_F(MeshFile, SaysWhatAPlyLacks) {
    const std::string vertices =
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n";
    const std::string z = "property float z\n";
    const std::string faces = "element face 0\nproperty list uchar int vertex_index\n";
    EXPECT_EQ(ply_error(vertices + z + faces + "end_header\n0 0 0"), "no error");
    EXPECT_THAT(ply_error(vertices + faces + "end_header\n0 0 0"), HasSubstr("without x y z"));
    EXPECT_THAT(ply_error(vertices + z + "end_header\n0 0 0"),
                HasSubstr("no element is named 'face'"));
    EXPECT_THAT(ply_error(vertices + z + "element face 0\nend_header\n0 0 0"),
                HasSubstr("faces without an integer list"));
    EXPECT_THAT(ply_error(vertices + z + vertices.substr(vertices.find("element")) + z + faces +
                          "end_header\n0 0 0 0 0 0"),
                HasSubstr("two elements are named 'vertex'"));
    EXPECT_THAT(ply_error(vertices + z + "element face 0\nproperty list float int vertex_index\n"),
                HasSubstr("a list's length of type float"));
}

}  // namespace
}  // namespace misbench
