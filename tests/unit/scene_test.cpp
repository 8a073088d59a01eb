#include "renderer/scene/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <filesystem>
#include <fstream>

#include "renderer/base/error.h"
#include "renderer/base/files.h"
#include "renderer/scene/camera.h"
#include "renderer/scene/load.h"
#include "renderer/scene/obj.h"
#include "renderer/scene/ply.h"
#include "renderer/scene/seesharp.h"
#include "tests/support/scenes.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

const fs::path kScenes = MISBENCH_SCENES;

class SceneFile : public testing::Test {
 protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("misbench_scene_" + std::to_string(::getpid()));
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    fs::path write(const std::string& name, const std::string& bytes) const {
        std::ofstream(folder_ / name, std::ios::binary) << bytes;
        return folder_ / name;
    }
    // The message of the error that reading the JSON gives.
    std::string error_of(const std::string& json) const {
        try {
            import_seesharp(write("s.json", json));
        } catch (const Error& e) {
            return e.what();
        }
        return "no error";
    }
    fs::path folder_;
};

struct Counts {
    const char* file;
    std::size_t triangles;
    std::size_t emissive;
};

// The counts of the scene pack's own manifest.
TEST(Scenes, HaveTheTrianglesAndLightsThatTheirAuthorsGaveThem) {
    for (const Counts& expected :
         {Counts{"VeachMIS/VeachMIS.json", 1938, 1920}, Counts{"Box/LightCenter.json", 850, 8},
          Counts{"Box/LightTop.json", 850, 8}, Counts{"CornellBox/CornellBox.json", 36, 2}}) {
        const LoadedScene loaded = load_scene(kScenes / expected.file, 1);
        EXPECT_EQ(loaded.scene->triangles().size(), expected.triangles) << expected.file;
        EXPECT_EQ(loaded.scene->lights().size(), expected.emissive) << expected.file;
    }
}

TEST(Scenes, AreListedByFolderOrByFolderAndFile) {
    std::vector<std::string> names;
    for (const SceneListing& scene : list_scenes(kScenes)) names.push_back(scene.name);
    EXPECT_THAT(names, testing::IsSupersetOf(
                           {"Box/LightCenter", "Box/LightTop", "CornellBox", "VeachMIS"}));
}

TEST_F(SceneFile, HashesTheSameWhereverItLiesAndDifferentlyWhenAMeshChanges) {
    const auto copy = folder_ / "elsewhere";
    fs::copy(kScenes / "VeachMIS", copy, fs::copy_options::recursive);
    const std::string hash = scene_content_hash(kScenes / "VeachMIS/VeachMIS.json");
    EXPECT_EQ(scene_content_hash(copy / "VeachMIS.json"), hash);
    std::ofstream(copy / "meshes/mesh3.ply", std::ios::app) << "x";
    EXPECT_NE(scene_content_hash(copy / "VeachMIS.json"), hash);
    fs::remove(copy / "meshes/mesh3.ply");
    EXPECT_THAT([&] { scene_content_hash(copy / "VeachMIS.json"); },
                ThrowsMessage<Error>(HasSubstr("mesh3.ply': no such file")));
}

constexpr std::string_view kMinimalScene = R"({
    // Comments are allowed.
    "transforms": [{"name": "c", "position": [1, 2, 3], "rotation": [0, 90, 0]}],
    "cameras": [{"name": "old", "type": "perspective", "fov": 10, "transform": "c"},
                {"name": "last", "type": "perspective", "fov": 40, "transform": "c"}],
    "materials": [{"name": "m", "type": "diffuse", "baseColor": {"type": "rgb", "value": [1, 1, 1]}},
                  {"name": "glass", "specularTransmittance": 1.0}],
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

TEST_F(SceneFile, TakesTheLastCameraNormalisesNormalsAndIgnoresUnusedMaterials) {
    const SceneDescription scene =
        import_seesharp(write("s.json", "\xEF\xBB\xBF" + std::string(kMinimalScene)));
    EXPECT_EQ(scene.camera.vertical_fov_degrees, 40);
    ASSERT_EQ(scene.meshes.size(), 1U);
    EXPECT_EQ(scene.meshes[0].normals[0], (Vec3{0, 0, 1}));
    EXPECT_EQ(scene.meshes[0].emission, (Rgb{2, 3, 4}));
    EXPECT_EQ(scene.materials.size(), 1U);
}

TEST_F(SceneFile, RotatesTheCameraAboutYToLookAlongMinusX) {
    const SceneDescription scene = import_seesharp(write("s.json", std::string(kMinimalScene)));
    const Ray ray = Camera(scene.camera, 100, 100).ray({50, 50});
    EXPECT_EQ(ray.origin, (Vec3{1, 2, 3}));
    EXPECT_NEAR(ray.direction.x, -1, 1e-6);
}

TEST_F(SceneFile, ReadsAMatrixAsRowVectorsWithTheTranslationLast) {
    const SceneDescription scene = import_seesharp(
        write("s.json", with(R"("position": [1, 2, 3], "rotation": [0, 90, 0])",
                             R"("matrix": [0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 7, 8, 9, 1])")));
    const Ray ray = Camera(scene.camera, 100, 100).ray({50, 50});
    EXPECT_EQ(ray.origin, (Vec3{7, 8, 9}));
    // The third row is the image of the z axis; the camera looks against it.
    EXPECT_EQ(ray.direction, (Vec3{-1, 0, 0}));
}

TEST_F(SceneFile, NamesThePlaceOfWhatItCannotRead) {
    EXPECT_THAT(error_of("{"), AllOf(HasSubstr("s.json"), HasSubstr("line 1")));
    EXPECT_THAT(error_of(with("\"material\": \"m\"", "\"material\": \"x\"")),
                HasSubstr("objects[0]: unknown material 'x'; known: 'glass' 'm'"));
    EXPECT_THAT(error_of(with("\"material\": \"m\"", "\"material\": \"glass\"")),
                HasSubstr("transmission is not supported"));
    EXPECT_THAT(error_of(with("trimesh", "fbx")),
                HasSubstr("objects[0].type: objects of type 'fbx' are not supported"));
    EXPECT_THAT(error_of(with("\"indices\": [0, 1, 2]", "\"indices\": [0, 1, 3]")),
                HasSubstr("objects[0].indices: index 3 names none of 3 vertices"));
    EXPECT_THAT(error_of(with("[2, 3, 4]", "[2, -3, 4]")),
                HasSubstr("objects[0].emission: a colour must be finite and not negative"));
    EXPECT_THAT(error_of(with("\"fov\": 40", "\"fov\": 180")), HasSubstr("cameras[1].fov"));
    EXPECT_THAT(
        error_of(with("\"type\": \"rgb\", \"value\": [1", "\"type\": \"image\", \"value\": [1")),
        HasSubstr("materials[0].baseColor: colours of type 'image' are not supported"));
}

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

TEST_F(SceneFile, ReadsPlyInAllThreeEncodings) {
    std::string ascii = ply_header("ascii");
    for (const auto& vertex : kSquare) {
        for (const float value : vertex) ascii += std::to_string(value) + " ";
    }
    ascii += "\n4 0 1 2 3\n";
    for (const std::string& bytes : {ascii, binary_ply(false), binary_ply(true)}) {
        const Mesh mesh = read_ply(write("m.ply", bytes));
        ASSERT_EQ(mesh.positions.size(), 4U);
        EXPECT_EQ(mesh.positions[2], (Vec3{1, 1, 0}));
        EXPECT_EQ(mesh.uvs[3], (Vec2{0, 1}));
        EXPECT_TRUE(mesh.normals.empty());
        EXPECT_THAT(mesh.triangles,
                    testing::ElementsAre(TriangleIndices{0, 1, 2}, TriangleIndices{0, 2, 3}));
    }
}

TEST_F(SceneFile, RefusesEveryPlyThatIsCutShort) {
    const std::string whole = binary_ply(false);
    for (std::size_t size = 0; size < whole.size(); ++size) {
        const fs::path file = write("m.ply", whole.substr(0, size));
        EXPECT_THAT([&] { read_ply(file); }, ThrowsMessage<Error>(HasSubstr("m.ply': byte ")))
            << size;
    }
}

TEST_F(SceneFile, RefusesAPlyThatPromisesMoreThanItHolds) {
    std::string bytes = binary_ply(false);
    bytes.replace(bytes.find("vertex 4"), 8, "vertex 4000000000000");
    EXPECT_THAT([&] { read_ply(write("m.ply", bytes)); },
                ThrowsMessage<Error>(HasSubstr("a count is larger than the file")));
    std::string bad_index = binary_ply(false);
    bad_index[bad_index.size() - 4] = 9;
    EXPECT_THAT([&] { read_ply(write("m.ply", bad_index)); },
                ThrowsMessage<Error>(HasSubstr("a face names vertex 9")));
}

TEST_F(SceneFile, ReadsObjPartsByMaterialWithFansAndTurnedV) {
    const auto parts = read_obj(write("m.obj",
                                      "mtllib missing.mtl\n# comment\nv 0 0 0\nv 1 0 0\nv 1 1 0\n"
                                      "v 0 1 0\nvt 0 0.25\nvn 0 0 1\no a\nusemtl one\ns off\n"
                                      "f 1/1/1 2/1/1 3/1/1 4/1/1\nl 1 2\nusemtl two.x\n"
                                      "f -4//1 -3//1 -2//1\r\n"));
    ASSERT_EQ(parts.size(), 2U);
    EXPECT_EQ(parts[0].material, "one");
    EXPECT_THAT(parts[0].mesh.triangles,
                testing::ElementsAre(TriangleIndices{0, 1, 2}, TriangleIndices{0, 2, 3}));
    EXPECT_EQ(parts[0].mesh.uvs[0], (Vec2{0, 0.75F}));
    EXPECT_EQ(parts[1].material, "two.x");
    EXPECT_TRUE(parts[1].mesh.uvs.empty());
    EXPECT_EQ(parts[1].mesh.positions[2], (Vec3{1, 1, 0}));
}

TEST_F(SceneFile, NamesTheLineOfABrokenObj) {
    const auto error = [this](const std::string& text) {
        const fs::path file = write("m.obj", text);
        try {
            read_obj(file);
        } catch (const Error& e) {
            return std::string(e.what());
        }
        return std::string("no error");
    };
    EXPECT_THAT(error("v 0 0 0\nv 1 x 0\n"), HasSubstr("line 2: 'x' is not a number"));
    EXPECT_THAT(error("v 0 0\n"), HasSubstr("line 1: '' is not a number"));
    EXPECT_THAT(error("v 0 0 0\nf 1 2 3\n"), HasSubstr("line 2: face index '2' names none of 1"));
    EXPECT_THAT(error("v 0 0 0\nf 1 1\n"), HasSubstr("fewer than three corners"));
}

TEST(Scene, EmitsOnTheSideOfTheShadingNormalOnly) {
    const Scene scene(test::furnace(DiffuseMaterial{}, {1, 1, 1}), 1);
    const auto inside = scene.closest({{0, 0, 0}, {0, -1, 0}});
    ASSERT_TRUE(inside);
    EXPECT_EQ(scene.emitted(*inside, {0, 1, 0}), (Rgb{1, 1, 1}));
    EXPECT_EQ(scene.emitted(*inside, {0, -1, 0}), Rgb{});
}

TEST(Scene, HasNoHitForARayThatEscapes) {
    const Scene scene(test::floor_under_lamp({}, {1, 1, 1}), 1);
    EXPECT_FALSE(scene.closest({{0, 1, 0}, {1, 0.5F, 0}}));
    EXPECT_TRUE(scene.closest({{0, 1, 0}, {0, -1, 0}}));
}

// Rays that leave a surface must not meet it again, wherever the scene lies and however large it
// is; and surface points must see each other when nothing is between them.
TEST(Scene, LeavesASurfaceWithoutMeetingItAgain) {
    for (const float scale : {1e-4F, 1.0F, 1e4F}) {
        for (const float shift : {0.0F, 100.0F}) {
            SceneDescription description = test::furnace(DiffuseMaterial{}, {1, 1, 1});
            for (Mesh& mesh : description.meshes) {
                for (Vec3& p : mesh.positions) p = scale * (p + Vec3{shift, shift, shift});
            }
            const Scene scene(std::move(description), 1);
            int n_blocked = 0;
            for (std::uint32_t from = 0; from < 12; ++from) {
                for (std::uint32_t to = 0; to < 12; ++to) {
                    if (from / 2 == to / 2) continue;
                    for (float u = 0.05F; u < 1; u += 0.1F) {
                        const SurfacePoint a = scene.point_on(from, {0.3F * u, 0.9F - 0.8F * u});
                        const SurfacePoint b = scene.point_on(to, {0.2F + 0.1F * u, 0.5F * u});
                        n_blocked += scene.visible(a, b) ? 0 : 1;
                    }
                }
            }
            EXPECT_EQ(n_blocked, 0) << "scale " << scale << " shift " << shift;
        }
    }
}

TEST(Accelerator, IsTightAtTheEdgesOfItsTriangles) {
    const Scene scene(test::furnace(DiffuseMaterial{}, {1, 1, 1}), 1);
    for (int i = 0; i <= 1000; ++i) {
        const float t = static_cast<float>(i) / 500 - 1;
        ASSERT_TRUE(scene.closest({{0, 0, 0}, {t, -1, -t}})) << "the floor's diagonal";
        ASSERT_TRUE(scene.closest({{0, 0, 0}, {t, -1, -1}})) << "the edge of floor and back";
    }
}

TEST(LightSampler, GivesEveryLightItsProbability) {
    const std::vector<EmissiveTriangle> lights = {
        {.triangle = 0, .area = 1, .radiance = {1, 1, 1}},
        {.triangle = 1, .area = 3, .radiance = {1, 1, 1}},
        {.triangle = 2, .area = 1, .radiance = {4, 4, 4}}};
    const LightSampler uniform(lights, find_light_selection("uniform"));
    const LightSampler power(lights, find_light_selection("power"));
    EXPECT_DOUBLE_EQ(uniform.probability(2), 1.0 / 3);
    EXPECT_NEAR(power.probability(0), 0.125, 1e-7);
    EXPECT_NEAR(power.probability(2), 0.5, 1e-7);
    std::array<int, 3> counts{};
    for (int i = 0; i < 8000; ++i) {
        ++counts[power.select((static_cast<float>(i) + 0.5F) / 8000)];
    }
    EXPECT_THAT(counts, testing::ElementsAre(1000, 3000, 4000));
    EXPECT_EQ(power.select(0x1.fffffep-1F), 2U);
    EXPECT_THROW(find_light_selection("bright"), ParameterError);
}

}  // namespace
}  // namespace misbench
