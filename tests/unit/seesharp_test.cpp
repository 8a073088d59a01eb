#include "renderer/scene/seesharp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/base/error.h"
#include "renderer/image/image.h"
#include "renderer/scene/camera.h"
#include "tests/support/temporary_folder.h"

namespace misbench {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

class SeeSharp : public testing::Test {
 protected:
    SceneDescription read(std::string_view json) const {
        return import_seesharp(folder_.write("s.json", json));
    }
    // The message of the error that reading the JSON gives.
    std::string error_of(std::string_view json) const {
        try {
            read(json);
        } catch (const Error& e) {
            return e.what();
        }
        return "no error";
    }
    // A square of one grey.
    void write_png(const std::string& name) const {
        Image image(2, 2);
        std::fill(image.rgb.begin(), image.rgb.end(), 0.5F);
        folder_.write(name, encode_png(image, 0));
    }
    TemporaryFolder folder_;
};

constexpr std::string_view kMinimalScene = R"({
    // Comments are allowed.
    "transforms": [{"name": "c", "position": [1, 2, 3], "rotation": [0, 90, 0]}],
    "cameras": [{"name": "old", "type": "perspective", "fov": 10, "transform": "c"},
                {"name": "last", "type": "perspective", "fov": 40, "transform": "c"}],
    "materials": [{"name": "m", "type": "diffuse", "baseColor": {"type": "rgb", "value": [1, 1, 1]}},
                  {"name": "odd", "baseColor": {"type": "checker"}}],
    "objects": [{"name": "o", "type": "trimesh", "material": "m",
                 "emission": {"type": "rgb", "value": [2, 3, 4]},
                 "vertices": [0, 0, 0, 1, 0, 0, 0, 1, 0], "indices": [0, 1, 2],
                 "normals": [0, 0, 9, 0, 0, 9, 0, 0, 9]}]})";

std::string with(std::string_view from, std::string_view to) {
    std::string text(kMinimalScene);
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

TEST_F(SeeSharp, TakesTheLastCameraNormalisesNormalsAndIgnoresUnusedMaterials) {
    const SceneDescription scene = read("\xEF\xBB\xBF" + std::string(kMinimalScene));
    EXPECT_EQ(scene.camera.fov_degrees, 40);
    ASSERT_EQ(scene.meshes.size(), 1U);
    EXPECT_EQ(scene.meshes[0].normals[0], (Vec3{0, 0, 1}));
    EXPECT_EQ(scene.meshes[0].emission, (Rgb{2, 3, 4}));
    EXPECT_EQ(scene.materials.size(), 1U);
}

TEST_F(SeeSharp, RotatesTheCameraAboutYToLookAlongMinusX) {
    const SceneDescription scene = read(kMinimalScene);
    const Ray ray = Camera(scene.camera, 100, 100).ray({50, 50}, {});
    EXPECT_EQ(ray.origin, (Vec3{1, 2, 3}));
    EXPECT_NEAR(ray.direction.x, -1, 1e-6);
}

TEST_F(SeeSharp, ReadsAMatrixAsRowVectorsWithTheTranslationLast) {
    const SceneDescription scene =
        read(with(R"("position": [1, 2, 3], "rotation": [0, 90, 0])",
                  R"("matrix": [0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 7, 8, 9, 1])"));
    const Ray ray = Camera(scene.camera, 100, 100).ray({50, 50}, {});
    EXPECT_EQ(ray.origin, (Vec3{7, 8, 9}));
    // The third row is the image of the z axis; the camera looks against it.
    EXPECT_EQ(ray.direction, (Vec3{-1, 0, 0}));
}

TEST_F(SeeSharp, NamesThePlaceOfWhatItCannotRead) {
    EXPECT_THAT(error_of("{"), AllOf(HasSubstr("s.json"), HasSubstr("line 1")));
    EXPECT_THAT(error_of(with("\"material\": \"m\"", "\"material\": \"x\"")),
                HasSubstr("objects[0]: unknown material 'x'; known: 'm' 'odd'"));
    EXPECT_THAT(error_of(with("\"material\": \"m\"", "\"material\": \"odd\"")),
                HasSubstr("materials[1].baseColor: colours of type 'checker' are not supported"));
    EXPECT_THAT(error_of(with("trimesh", "fbx")),
                HasSubstr("objects[0].type: objects of type 'fbx' are not supported"));
    EXPECT_THAT(error_of(with("\"indices\": [0, 1, 2]", "\"indices\": [0, 1, 3]")),
                HasSubstr("objects[0].indices: index 3 names none of 3 vertices"));
    EXPECT_THAT(error_of(with("\"indices\": [0, 1, 2]", "\"indices\": [0, 1, 1.5]")),
                HasSubstr("objects[0].indices: index 1.5 names none"));
    EXPECT_THAT(error_of(with("[2, 3, 4]", "[2, -3, 4]")),
                HasSubstr("objects[0].emission: a colour must not be negative"));
    EXPECT_THAT(error_of(with("[2, 3, 4]", "[2, 3, 4, 5]")),
                HasSubstr("objects[0].emission.value: expected 3 numbers, found 4"));
    EXPECT_THAT(error_of(with("[2, 3, 4]", "[2, true, 4]")),
                HasSubstr("objects[0].emission.value[1]: expected a number of single precision, "
                          "found true"));
    EXPECT_THAT(error_of(with("[0, 0, 0, 1,", "[0, 0, 1e39, 1,")),
                HasSubstr("objects[0].vertices[2]: expected a number of single precision"));
    EXPECT_THAT(error_of(with("\"fov\": 40", "\"fov\": 180")), HasSubstr("cameras[1].fov"));
    EXPECT_THAT(error_of(with("\"value\": [1, 1, 1]", "\"value\": [1, 2, 1]")),
                HasSubstr("materials[0].baseColor: reflects more light than it receives"));
    EXPECT_THAT(error_of(with("\"rotation\"", "\"scale\": [1, 0, 1], \"rotation\"")),
                HasSubstr("transforms[0]: the transform cannot be inverted"));
    EXPECT_THAT(error_of(with("\"name\": \"odd\"", "\"name\": \"m\"")),
                HasSubstr("materials[1]: the name 'm' is taken"));
}

TEST_F(SeeSharp, ReadsTrailingCommasWhereAValueStandsBefore) {
    EXPECT_EQ(error_of(with("[0, 1, 2]", "[0, 1, 2, /* , */ ]")), "no error");
    // Not in strings.
    EXPECT_EQ(read(with("\"name\": \"o\"", "\"name\": \"o,]\\\",}\"")).meshes[0].name, "o,]\",}");
    EXPECT_EQ(error_of(with("[0, 1, 2],", "[0, 1, 2], \"deep\": [{\"a\": 1,},],")), "no error");
    EXPECT_THAT(error_of(with("[0, 1, 2]", "[0, 1, 2,,]")), HasSubstr("parse error at line"));
    EXPECT_THAT(error_of(with("[0, 1, 2]", "[,]")), HasSubstr("parse error at line"));
    // The places of other errors stay what they are.
    EXPECT_THAT(error_of("{\"a\": [1,\n],\n\"b\": x}"), HasSubstr("line 3, column 6"));
    EXPECT_THAT(error_of("{\"a\": [1,], \"b\": x}"), HasSubstr("line 1, column 18"));
}

TEST_F(SeeSharp, ReadsTexturesInBothSpellingsOnceAFile) {
    write_png("wood grain.png");
    write_png("r.png");
    const std::string json = with(R"("baseColor": {"type": "rgb", "value": [1, 1, 1]}})",
                                  R"("baseColor": {"type": "image", "filename": "wood grain.png"}},
           {"name": "g", "baseColor": {"type": "texture", "path": "wood grain.png"},
            "roughness": "r.png"})");
    const std::string second = R"({"name": "p", "type": "trimesh", "material": "g",
        "vertices": [0, 0, 0, 1, 0, 0, 0, 1, 0], "indices": [0, 1, 2], "uv": [0, 0, 1, 0, 0, 1]},)";
    const SceneDescription scene =
        read(std::string(json).replace(json.find("{\"name\": \"o\""), 0, second));
    ASSERT_EQ(scene.textures.size(), 2U);
    const auto& texture = std::get<BitmapTexture>(scene.textures[0]);
    EXPECT_EQ(texture.filter, BitmapTexture::Filter::Nearest);
    EXPECT_EQ(texture.wrap, BitmapTexture::Wrap::Repeat);
    ASSERT_EQ(scene.materials.size(), 2U);
    EXPECT_EQ(scene.materials[0].front.layer.color_texture, 0);
    EXPECT_EQ(scene.materials[0].front.layer.roughness_texture, 1);
    EXPECT_EQ(scene.materials[1].front.layer.color_texture, 0);
    EXPECT_EQ(scene.materials[1].front.layer.roughness_texture, kNoTexture);
    // The mesh without texture coordinates gets 0 0 everywhere.
    EXPECT_THAT(scene.meshes[1].uvs, ElementsAre(Vec2{}, Vec2{}, Vec2{}));
    EXPECT_THAT(scene.notes, ElementsAre(HasSubstr("object 'o' has no texture coordinates")));
    EXPECT_THAT(error_of(with(R"({"type": "rgb", "value": [1, 1, 1]})",
                              R"({"type": "image", "filename": "none.png"})")),
                HasSubstr("none.png': no such file"));
}

TEST_F(SeeSharp, TakesCoordinatesThatAreNotFiniteOnlyWhereNoTextureReadsThem) {
    write_png("t.png");
    folder_.write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt nan nan\nusemtl m\nf 1/1 2/1 3/1\n");
    const std::string obj =
        with(R"("type": "trimesh", "material": "m")", R"("type": "obj", "relativePath": "m.obj")");
    EXPECT_EQ(error_of(obj), "no error");
    std::string textured = obj;
    const std::string rgb = R"({"type": "rgb", "value": [1, 1, 1]})";
    textured.replace(textured.find(rgb), rgb.size(), R"({"type": "image", "filename": "t.png"})");
    EXPECT_THAT(error_of(textured),
                HasSubstr("objects[0]: a texture coordinate under material 'm' is not finite"));
    folder_.write("m.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
    EXPECT_THAT(error_of(obj), HasSubstr("objects[0]: a vertex is not finite"));
}

TEST_F(SeeSharp, ReadsABackgroundByItsNearestPixels) {
    Image sky(1, 1);
    sky.rgb = {1, 1, 1};
    write_exr(folder_.path() / "sky 1.exr", sky);
    const SceneDescription scene = read(with(
        "\"objects\"", R"("background": {"type": "image", "filename": "sky 1.exr"}, "objects")"));
    ASSERT_TRUE(scene.environment);
    EXPECT_EQ(*scene.environment->radiance, sky);
    EXPECT_EQ(scene.environment->filter, EnvironmentDescription::Filter::Nearest);
    EXPECT_EQ(scene.environment->to_world.rows, Transform{}.rows);
    EXPECT_THAT(error_of(with("\"objects\"", R"("background": {"type": "sun"}, "objects")")),
                HasSubstr("background.type: backgrounds of type 'sun' are not supported"));
}

TEST_F(SeeSharp, NotesOnceWhatTheFormatsOwnRendererIgnores) {
    const SceneDescription scene =
        read(with(R"({"name": "m", "type": "diffuse", )",
                  R"({"name": "m", "thin": true, "diffuseTransmittance": 0.0,
                      "specularTintStrength": 0.5, )"));
    EXPECT_THAT(scene.notes, ElementsAre("'specularTintStrength' is ignored, as SeeSharp does: 'm'",
                                         "'thin' is ignored, as SeeSharp does: 'm'"));
    EXPECT_THAT(error_of(with("\"type\": \"diffuse\",", "\"type\": \"diffuse\", \"thin\": true,")),
                HasSubstr("materials[0].thin: diffuse transmission is not supported"));
}

TEST_F(SeeSharp, RefusesGlossyEmissionWhereThereIsEmission) {
    const auto scene = [](const std::string& radiance) {
        return with("\"type\": \"diffuse\",",
                    R"("emissionIsGlossy": true, "emission": {"value": )" + radiance + "},");
    };
    EXPECT_EQ(error_of(scene("[0, 0, 0]")), "no error");
    EXPECT_THAT(error_of(scene("[0, 1, 0]")),
                HasSubstr("materials[0].emissionIsGlossy: glossy emission is not supported"));
    EXPECT_THAT(error_of(with("\"emission\": {", "\"emission\": {\"unit\": \"watt\", ")),
                HasSubstr("objects[0].emission.unit: unknown unit 'watt'; known: radiance"));
}

// Printing such a value to an error message would run out of stack.
TEST_F(SeeSharp, RefusesDeeplyNestedValues) {
    constexpr std::size_t kDepth = 200'000;
    const std::string nested = std::string(kDepth, '[') + std::string(kDepth, ']');
    EXPECT_THAT(error_of(with("\"fov\": 40", "\"fov\": " + nested)),
                HasSubstr("cameras[1].fov: expected a number of single precision, found array"));
    EXPECT_THAT(error_of(with("\"indices\": [0, 1, 2]", "\"indices\": [0, 1, " + nested + "]")),
                HasSubstr("index array names none of 3"));
}

}  // namespace
}  // namespace misbench
