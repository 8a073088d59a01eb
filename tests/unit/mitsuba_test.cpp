// The language of Mitsuba's XML scenes, and their shapes. Numbers marked (M3) were taken from
// Mitsuba 3.9 itself.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>

#include "tests/support/mitsuba_fixture.h"

namespace misbench::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// --- The language ---------------------------------------------------------------------------

TEST_F(Mitsuba, ReplacesParametersInEveryAttributeTheFirstDefaultWinning) {
    const SceneDescription scene = read_all(
        "<default name=\"kind\" value=\"perspective\"/><default name=\"kind\" value=\"other\"/>"
        "<default name=\"f\" value=\"1\"/><default name=\"fov\" value=\"33\"/>"
        "<sensor type=\"$kind\"><float name=\"fov\" value=\"$fov\"/></sensor>");
    EXPECT_EQ(scene.camera.fov_degrees, 33);
    EXPECT_THAT(error_of("<shape type=\"$what\"/>"),
                AllOf(HasSubstr("line 1:"), HasSubstr("'$what'")));
}

TEST_F(Mitsuba, SharesAMaterialBetweenTheShapesThatReferToIt) {
    const SceneDescription scene = read(
        "<shape type=\"cube\"><ref id=\"grey\"/></shape>"
        "<bsdf type=\"diffuse\" id=\"grey\"><rgb name=\"reflectance\" value=\"0.25\"/></bsdf>"
        "<alias id=\"grey\" as=\"gray\"/><shape type=\"rectangle\"><ref id=\"gray\"/></shape>"
        "<bsdf type=\"hair\" id=\"never used\"/>");
    ASSERT_EQ(scene.materials.size(), 1U);
    EXPECT_EQ(scene.materials[0].name, "grey");
    EXPECT_EQ(std::get<DiffuseMaterial>(scene.materials[0].front.layer.material).reflectance,
              (Rgb{0.25F, 0.25F, 0.25F}));
    EXPECT_THAT(error_of("<shape type=\"cube\"><ref id=\"x\"/></shape>"),
                HasSubstr("unknown id 'x'"));
}

TEST_F(Mitsuba, ReadsIncludesAndNamesTheirFilesInErrors) {
    write("part.xml", "<scene version=\"3.0.0\">\n<shape type=\"cube\"/>\n</scene>");
    EXPECT_EQ(read("<include filename=\"part.xml\"/>").meshes.size(), 1U);
    write("part.xml", "<scene version=\"3.0.0\">\n<shape type=\"blob\"/>\n</scene>");
    EXPECT_THAT(
        error_of("<include filename=\"part.xml\"/>"),
        AllOf(HasSubstr("part.xml': line 2:1: shape 'blob' is not supported; known: obj ply")));
    write("loop.xml", "<scene version=\"3.0.0\"><include filename=\"loop.xml\"/></scene>");
    EXPECT_THAT(error_of("<include filename=\"loop.xml\"/>"),
                HasSubstr("includes are nested too deeply"));
    EXPECT_THAT(error_of("<include filename=\"none.xml\"/>"), HasSubstr("none.xml"));
}

TEST_F(Mitsuba, ListsTheFilesThatItRefersToInOrder) {
    write("part.xml", "<scene version=\"3.0.0\">" + obj("b.obj") + "</scene>");
    const fs::path file = write(
        "s.xml", "<scene version=\"3.0.0\"><default name=\"n\" value=\"a\"/>" + obj("$n.obj") +
                     "<include filename=\"part.xml\"/>" + obj("c d.obj") + "</scene>");
    EXPECT_THAT(mitsuba_references(file), ElementsAre("a.obj", "part.xml", "b.obj", "c d.obj"));
}

TEST_F(Mitsuba, NamesTheLineAndWhatIsKnownWhereAParameterIsUnknown) {
    EXPECT_THAT(
        error_of("\n\n <shape type=\"sphere\">\n  <float name=\"radios\" value=\"1\"/></shape>"),
        HasSubstr("s.xml': line 4:3: unknown parameter 'radios' of shape 'sphere'; known: "
                  "center flip_normals radius to_world"));
    EXPECT_THAT(error_of("<medium type=\"homogeneous\"/>"),
                HasSubstr("cannot hold medium 'homogeneous'"));
    EXPECT_THAT(shape_error("<medium name=\"interior\" type=\"homogeneous\"/>"),
                HasSubstr("shape 'rectangle' cannot hold medium 'homogeneous' as 'interior'"));
}

TEST_F(Mitsuba, RefusesBrokenFiles) {
    const auto error = [&](const std::string& xml) {
        return message_of([&] { import_mitsuba(write("s.xml", xml)); });
    };
    EXPECT_THAT(error(""), HasSubstr("s.xml': line 1:"));
    EXPECT_THAT(error("<scene version=\"3.0.0\">\n<shape></scene>"), HasSubstr("line 2:"));
    EXPECT_THAT(error("<world/>"), HasSubstr("expected <scene>, found <world>"));
    EXPECT_THAT(error("<scene/>"), HasSubstr("version '' is not supported; known: 0.5 0.6 2 3"));
    EXPECT_THAT(error("<scene version=\"3.0.0\"/>"), HasSubstr("the scene has no sensor"));
    EXPECT_THAT(error("<scene version=\"3.0.0\"><path value=\"x\"/></scene>"),
                HasSubstr("unknown element <path>"));
    EXPECT_THAT(error_of("<shape type=\"sphere\"><float name=\"radius\" value=\"big\"/></shape>"),
                HasSubstr("'radius': 'big' is not a finite number"));
    EXPECT_THAT(error_of("<shape type=\"sphere\"><float name=\"radius\" value=\"0\"/></shape>"),
                HasSubstr("'radius': must be above 0"));
    EXPECT_THAT(error_of("<shape type=\"sphere\"><string name=\"radius\" value=\"1\"/></shape>"),
                HasSubstr("'radius': expected a float, found a string"));
    EXPECT_THAT(error_of("<shape type=\"sphere\"><float name=\"radius\" value=\"1\"/>"
                         "<float name=\"radius\" value=\"1\"/></shape>"),
                HasSubstr("'radius': is given twice"));
    EXPECT_THAT(shape_error(to_world("<scale x=\"0\"/>")),
                HasSubstr("'to_world' cannot be inverted"));
    EXPECT_THAT(shape_error(to_world("<shear x=\"0\"/>")), HasSubstr("unknown element <shear>"));
    EXPECT_THAT(shape_error(to_world("<matrix value=\"1 2 3\"/>")),
                HasSubstr("expected 16 or 9 numbers"));
    EXPECT_THAT(shape_error("<bsdf type=\"mask\" id=\"m\"><ref id=\"m\"/></bsdf>"),
                HasSubstr("refers to itself"));
    std::string deep;
    for (int i = 0; i < 100; ++i) deep += "<bsdf type=\"twosided\">";
    for (int i = 0; i < 100; ++i) deep += "</bsdf>";
    EXPECT_THAT(error_of(deep), HasSubstr("nested too deeply"));
    std::string doubling = "<default name=\"p0\" value=\"xxxxxxxx\"/>";
    for (int i = 0; i < 20; ++i) {
        const std::string p = "$p" + std::to_string(i) + ".";
        doubling += "<default name=\"p" + std::to_string(i + 1) + ".\" value=\"" + p + p + "\"/>";
        if (i == 0) doubling = "<default name=\"p0.\" value=\"xxxxxxxx\"/>" + doubling;
    }
    EXPECT_THAT(error_of(doubling), HasSubstr("parameters expand without end"));
}

TEST_F(Mitsuba, AppliesTheOperationsOfATransformInOrder) {
    const auto corner = [&](const std::string& operations) {
        return rectangle(to_world(operations)).meshes.at(0).positions.at(2);  // (1, 1, 0)
    };
    expect_near(corner("<scale value=\"2\"/><translate x=\"1\" z=\"3\"/>"), {3, 2, 3});
    expect_near(corner("<translate value=\"1, 0, 3\"/><scale x=\"2\"/>"), {4, 1, 3});
    expect_near(corner("<rotate y=\"1\" angle=\"90\"/>"), {0, 1, -1});
    expect_near(corner("<matrix value=\"0 0 1 5  1 0 0 6  0 1 0 7  0 0 0 1e+000\"/>"), {5, 7, 8});
    // z towards the target, x to the left.
    expect_near(corner("<lookat origin=\"0 0 5\" target=\"0 0 0\" up=\"0 1 0\"/>"), {-1, 1, 5});
    EXPECT_THAT(shape_error(to_world("<lookat origin=\"0 0 0\" target=\"0 1 0\" up=\"0 1 0\"/>")),
                HasSubstr("'up' lies along the direction of view"));
}

// --- Shapes ---------------------------------------------------------------------------------

TEST_F(Mitsuba, BuildsRectanglesAndCubesAsMitsubaDoes) {
    const Mesh rectangle = read(shape("rectangle", "")).meshes.at(0);
    expect_near(face_normal(rectangle), {0, 0, 1});
    EXPECT_THAT(rectangle.normals, IsEmpty());
    EXPECT_EQ(rectangle.uvs[2], (Vec2{1, 1}));  // (1, 1, 0)
    const Mesh cube = read(shape("cube", "")).meshes.at(0);
    ASSERT_EQ(cube.triangles.size(), 12U);
    for (const auto& [a, b, c] : cube.triangles) {
        const Vec3 p = cube.positions[a], q = cube.positions[b], r = cube.positions[c];
        EXPECT_GT(dot(cross(q - p, r - p), p + q + r), 0);
    }
    // The face towards +z (M3).
    EXPECT_EQ(cube.positions[12], (Vec3{1, -1, 1}));
    EXPECT_EQ(cube.positions[13], (Vec3{1, 1, 1}));
    EXPECT_EQ(cube.positions[14], (Vec3{-1, 1, 1}));
    EXPECT_EQ(cube.uvs[12], (Vec2{0, 1}));
    EXPECT_EQ(cube.uvs[14], (Vec2{1, 0}));
}

TEST_F(Mitsuba, TurnsVOfObjFilesDownwardsUnlessToldOtherwise) {
    const std::string no = "<boolean name=\"flipTexCoords\" value=\"false\"/>";
    EXPECT_EQ(read(obj("flat.obj")).meshes.at(0).uvs.at(0), (Vec2{0, 1}));
    EXPECT_EQ(read(obj("flat.obj", no), "0.6.0").meshes.at(0).uvs.at(0), (Vec2{0, 0}));
    write("q.ply",
          "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
          "property float z\nproperty float u\nproperty float v\nelement face 1\n"
          "property list uchar int vertex_indices\nend_header\n"
          "0 0 0 0 0.25\n1 0 0 0 0\n1 1 0 0 0\n3 0 1 2\n");
    const auto ply = [&](const std::string& inside) {
        return read(shape("ply", "<string name=\"filename\" value=\"q.ply\"/>" + inside))
            .meshes.at(0);
    };
    EXPECT_EQ(ply("").uvs[0].y, 0.25F);
    EXPECT_EQ(ply("<boolean name=\"flip_tex_coords\" value=\"true\"/>").uvs[0].y, 0.75F);
}

TEST_F(Mitsuba, GivesAMeshWithoutNormalsSmoothOnesWeightedByAngle) {
    write("roof.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\n");
    const Mesh mesh = read(obj("roof.obj")).meshes.at(0);
    // Vertex 1 has angles of 45° in the face of normal +z and 90° in the one of normal +y.
    expect_near(mesh.normals.at(0), normalized({0, 2, 1}));
    expect_near(mesh.normals.at(2), {0, 0, 1});
    EXPECT_THAT(read(obj("roof.obj", "<boolean name=\"face_normals\" value=\"true\"/>"))
                    .meshes.at(0)
                    .normals,
                IsEmpty());
}

// What shows after each map: the sign of z of the shading normal, which decides emission (M3).
TEST_F(Mitsuba, KeepsTheSidesOfMitsubaUnderMirrorsAndFlips) {
    const std::string mirror = to_world("<scale x=\"-1\"/>");
    const std::string mirror_z = to_world("<scale z=\"-1\"/>");
    const std::string flip = "<boolean name=\"flip_normals\" value=\"true\"/>";
    const std::string flat = "<boolean name=\"face_normals\" value=\"true\"/>";
    struct Case {
        std::string xml;
        float z;
    };
    for (const Case& c :
         {Case{shape("rectangle", mirror), 1}, Case{shape("rectangle", mirror_z), -1},
          Case{shape("rectangle", flip), -1}, Case{shape("rectangle", mirror + flip), -1},
          Case{obj("flat.obj", mirror), -1}, Case{obj("flat.obj", mirror_z), 1},
          Case{obj("flat.obj", flip), -1}, Case{obj("flat.obj", mirror + flip), 1},
          Case{obj("flat.obj", mirror + flat), -1}, Case{obj("smooth.obj", mirror), 1},
          Case{obj("smooth.obj", mirror + flat), -1}, Case{obj("smooth.obj", flip), -1}}) {
        const Mesh mesh = read(c.xml).meshes.at(0);
        expect_near(face_normal(mesh), {0, 0, c.z});
        for (const Vec3 n : mesh.normals) expect_near(n, {0, 0, c.z});
    }
    const auto flipped = [&](const std::string& xml, const char* version = "3.0.0") {
        return read(xml, version).quadrics.at(0).flipped;
    };
    EXPECT_TRUE(flipped(shape("sphere", mirror)));
    EXPECT_FALSE(flipped(shape("sphere", mirror + flip)));
    EXPECT_FALSE(flipped(shape("sphere", to_world("<scale x=\"-1\"/>")), "0.6.0"));
    EXPECT_FALSE(flipped(shape("cylinder", mirror)));
    EXPECT_TRUE(flipped(shape("disk", flip)));
}

TEST_F(Mitsuba, MapsNormalsByTheInverseTransposed) {
    write("slope.obj",
          "v 0 0 0\nv 1 0 0\nv 0 1 -1\nvn 0 0.70710678 0.70710678\nf 1//1 2//1 3//1\n");
    const Mesh mesh = read(obj("slope.obj", to_world("<scale y=\"2\"/>"))).meshes.at(0);
    expect_near(mesh.normals[0], normalized({0, 1, 2}));
    expect_near(mesh.normals[0], face_normal(mesh));
}

TEST_F(Mitsuba, ReadsRoundShapesIntoTheirOwnFrames) {
    const Quadric sphere =
        read(shape("sphere",
                   "<point name=\"center\" x=\"1\" y=\"2\"/><float name=\"radius\" value=\"3\"/>" +
                       to_world("<scale value=\"2\"/>")))
            .quadrics.at(0);
    EXPECT_EQ(sphere.shape, Quadric::Shape::Sphere);
    expect_near(sphere.to_world.point({0, 0, 0}), {2, 4, 0});
    EXPECT_NEAR(length(sphere.to_world.direction({0, 1, 0})), 6, 1e-5F);
    const Quadric cylinder =
        read(shape("cylinder",
                   "<point name=\"p0\" x=\"1\"/><point name=\"p1\" x=\"1\" y=\"4\"/>"
                   "<float name=\"radius\" value=\"0.5\"/>"))
            .quadrics.at(0);
    expect_near(cylinder.to_world.point({0, 0, 0}), {1, 0, 0});
    expect_near(cylinder.to_world.point({0, 0, 1}), {1, 4, 0});
    EXPECT_NEAR(length(cylinder.to_world.direction({1, 0, 0})), 0.5F, 1e-6F);
    EXPECT_EQ(read(shape("disk", to_world("<scale z=\"5\"/>"))).quadrics.at(0).shape,
              Quadric::Shape::Disk);
    for (const char* bad : {"sphere", "cylinder", "disk"}) {
        EXPECT_THAT(error_of(shape(bad, to_world("<scale x=\"2\"/>"))),
                    HasSubstr("scales it differently"));
    }
    EXPECT_THAT(error_of(shape("sphere", to_world("<scale z=\"2\"/>"))),
                HasSubstr("scales it differently"));
}

TEST_F(Mitsuba, CopiesShapeGroups) {
    const std::string group = "<shape type=\"shapegroup\" id=\"g\">" + shape("cube", "") +
                              shape("sphere", "") + "</shape>";
    const auto copy = [](const std::string& inside) {
        return "<shape type=\"instance\"><ref id=\"g\"/>" + inside + "</shape>";
    };
    const SceneDescription scene = read(group + copy(to_world("<translate x=\"5\"/>")) +
                                        copy(to_world("<scale y=\"-2\" x=\"2\" z=\"2\"/>")));
    EXPECT_EQ(scene.n_instances, 2U);
    ASSERT_EQ(scene.meshes.size(), 2U);
    ASSERT_EQ(scene.quadrics.size(), 2U);
    EXPECT_EQ(scene.materials.size(), 1U);
    expect_near(scene.meshes[0].positions[0], {6, -1, -1});
    expect_near(scene.quadrics[0].to_world.translation(), {5, 0, 0});
    // A mirrored copy still looks outwards.
    const Mesh& mirrored = scene.meshes[1];
    EXPECT_GT(dot(face_normal(mirrored), mirrored.positions[mirrored.triangles[0][0]]), 0);
    EXPECT_THAT(error_of(group + copy(to_world("<scale x=\"2\"/>"))),
                HasSubstr("scales it differently"));
    EXPECT_THAT(error_of("<shape type=\"shapegroup\" id=\"g\">" +
                         shape("cube", "<emitter type=\"area\"/>") + "</shape>" + copy("")),
                HasSubstr("an emitter in a shapegroup is not supported"));
    EXPECT_THAT(error_of(shape("instance", "")),
                HasSubstr("expected one reference to a shapegroup"));
}

TEST_F(Mitsuba, RefusesMoreCopiedTrianglesThanTheLimitBeforeItMakesThem) {
    // One polygon of a million corners, copied 51 times.
    std::string polygon = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf";
    for (int i = 0; i < 1'000'002; ++i) polygon += " 1";
    write("big.obj", polygon + "\n");
    std::string scene = "<shape type=\"shapegroup\" id=\"g\">" + obj("big.obj") + "</shape>";
    for (int i = 0; i < 51; ++i) scene += "<shape type=\"instance\"><ref id=\"g\"/></shape>";
    EXPECT_THAT(error_of(scene),
                HasSubstr("copies of shape groups have more than 50000000 triangles"));
}

// --- Serialized meshes ----------------------------------------------------------------------

template <class T>
std::string raw(const std::vector<T>& values) {
    std::string bytes(values.size() * sizeof(T), '\0');
    std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
}

template <class Number>
std::string serialized_body(std::uint32_t flags, bool named, std::uint64_t n_vertices = 3) {
    const auto numbers = [](std::vector<Number> values) { return raw(values); };
    return raw<std::uint32_t>({flags}) + (named ? std::string("tri\0", 4) : "") +
           raw<std::uint64_t>({n_vertices, 1}) + numbers({0, 0, 0, 1, 0, 0, 0, 1, 7}) +
           ((flags & 1) != 0 ? numbers({0, 0, 2, 0, 0, 2, 0, 0, 2}) : "") +
           ((flags & 2) != 0 ? numbers({0, 0, 1, 0, 0, 1}) : "") +
           ((flags & 8) != 0 ? numbers({1, 1, 1, 1, 1, 1, 1, 1, 1}) : "") +
           raw<std::uint32_t>({0, 1, 2});
}

std::string serialized_file(const std::vector<std::string>& bodies, std::uint16_t version) {
    std::string file;
    std::vector<std::uint64_t> offsets;
    for (const std::string& body : bodies) {
        offsets.push_back(file.size());
        std::string packed(compressBound(body.size()), '\0');
        uLongf size = packed.size();
        compress(reinterpret_cast<Bytef*>(packed.data()), &size,
                 reinterpret_cast<const Bytef*>(body.data()), body.size());
        file += raw<std::uint16_t>({0x041C, version}) + packed.substr(0, size);
    }
    for (const std::uint64_t offset : offsets) {
        file += version == 4 ? raw<std::uint64_t>({offset})
                             : raw<std::uint32_t>({static_cast<std::uint32_t>(offset)});
    }
    return file + raw<std::uint32_t>({static_cast<std::uint32_t>(offsets.size())});
}

TEST_F(Mitsuba, ReadsSerializedMeshesOfBothVersionsAndPrecisions) {
    const auto mesh = [&](int index) {
        return read(shape("serialized",
                          "<string name=\"filename\" value=\"m\"/><integer name=\"shapeIndex\" "
                          "value=\"" +
                              std::to_string(index) + "\"/>"))
            .meshes.at(0);
    };
    write("m",
          serialized_file(
              {serialized_body<float>(0x1003, true), serialized_body<double>(0x2008, true)}, 4));
    EXPECT_EQ(mesh(0).positions.at(2), (Vec3{0, 1, 7}));
    expect_near(mesh(0).normals.at(1), {0, 0, 1});
    EXPECT_EQ(mesh(0).uvs.at(1), (Vec2{1, 0}));
    EXPECT_EQ(mesh(1).positions.at(2), (Vec3{0, 1, 7}));
    EXPECT_THAT(mesh(1).uvs, IsEmpty());
    EXPECT_EQ(mesh(1).triangles.at(0), (TriangleIndices{0, 1, 2}));
    write("m",
          serialized_file(
              {serialized_body<float>(0x1000, false), serialized_body<float>(0x1002, false)}, 3));
    EXPECT_EQ(mesh(1).uvs.at(2), (Vec2{0, 1}));
}

TEST_F(Mitsuba, RefusesBrokenSerializedMeshes) {
    const auto error = [&](const std::string& bytes, const std::string& index = "0") {
        write("m", bytes);
        return error_of(
            shape("serialized",
                  "<string name=\"filename\" value=\"m\"/><integer name=\"shape_index\" value=\"" +
                      index + "\"/>"));
    };
    const std::string good = serialized_file({serialized_body<float>(0x1000, true)}, 4);
    EXPECT_EQ(error(good), "no error");
    EXPECT_THAT(error(good, "1"), HasSubstr("mesh 1: the file has 1 meshes"));
    EXPECT_THAT(error(""), HasSubstr("the file is too short"));
    EXPECT_THAT(error("PK" + good), HasSubstr("not a serialized mesh"));
    EXPECT_THAT(error(serialized_file({serialized_body<float>(0x1000, true)}, 7)),
                HasSubstr("version 7 is not supported"));
    EXPECT_THAT(error(serialized_file({serialized_body<float>(0, true)}, 4)),
                HasSubstr("neither float nor double"));
    EXPECT_THAT(error(serialized_file({serialized_body<float>(0x1000, true).substr(0, 50)}, 4)),
                HasSubstr("the data end too early"));
    EXPECT_THAT(error(serialized_file({serialized_body<float>(0x1000, true, 2)}, 4)),
                HasSubstr("a triangle names vertex"));
    EXPECT_THAT(error(serialized_file({serialized_body<float>(0x1000, true, 1ULL << 40)}, 4)),
                HasSubstr("more than its bytes can hold"));
    std::string damaged = good;
    damaged[10] = static_cast<char>(damaged[10] ^ 0x55);
    EXPECT_NE(error(damaged), "no error");
    std::string bad_table = good;
    bad_table[good.size() - 12] = 100;
    EXPECT_THAT(error(bad_table), HasSubstr("names a place that holds no mesh"));
}

}  // namespace
}  // namespace misbench::test
