#include "renderer/scene/load.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/base/error.h"
#include "renderer/base/files.h"
#include "renderer/scene/scene.h"
#include "tests/support/temporary_folder.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

const fs::path kScenes = MISBENCH_SCENES;

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

constexpr std::string_view kJsonScene = R"({"cameras": [], "objects": []})";
constexpr std::string_view kXmlScene = R"(<scene version="3.0.0"></scene>)";

TEST(Scenes, AreListedInBothFormatsAndNothingElseIs) {
    const TemporaryFolder folder;
    folder.write("A/A.json", kJsonScene);
    folder.write("veach-mis/scene.xml", kXmlScene);
    folder.write("veach-bidir/scene.xml", kXmlScene);
    folder.write("veach-bidir/scene_features.xml", kXmlScene);
    folder.write("broken/broken.json", std::string(kJsonScene) + "}");
    folder.write("manifest.json", R"({"scenes": []})");
    folder.write("other.xml", "<feed version='1'></feed>");
    folder.write("A/README.md", kJsonScene);
    std::vector<std::string> names;
    for (const SceneListing& scene : list_scenes(folder.path())) names.push_back(scene.name);
    EXPECT_THAT(names, ElementsAre("A", "broken", "veach-bidir", "veach-bidir/scene_features",
                                   "veach-mis"));
}

TEST(Scenes, KeepAllOfTheirPathWhereTheyWouldShareAName) {
    const TemporaryFolder folder;
    folder.write("A/A.json", kJsonScene);
    folder.write("A/scene.xml", kXmlScene);
    folder.write("A/B.v2.json", kJsonScene);
    std::vector<std::string> names;
    for (const SceneListing& scene : list_scenes(folder.path())) names.push_back(scene.name);
    EXPECT_THAT(names, ElementsAre("A/A.json", "A/B.v2", "A/scene.xml"));
}

TEST(Scenes, TooLargeForSinglePrecisionAreRefused) {
    const TemporaryFolder folder;
    const fs::path file = folder.write("far.xml", R"(<scene version="3.0.0">
        <sensor type="perspective"/>
        <shape type="rectangle">
            <transform name="to_world"><scale value="1e17"/></transform>
        </shape>
    </scene>)");
    EXPECT_THAT(
        [&] { load_scene(file, 1); },
        ThrowsMessage<Error>(AllOf(HasSubstr("far.xml': mesh '"), HasSubstr("known: up to"))));
}

TEST(Scenes, OfAnUnknownFormatAreRefusedWithTheKnownOnes) {
    const TemporaryFolder folder;
    const fs::path file = folder.write("scene.pbrt", "");
    const auto is_one_line_with_formats =
        AllOf(HasSubstr("scene.pbrt': unknown format '.pbrt'; known: .json .xml"),
              testing::Not(HasSubstr("\n")));
    EXPECT_THAT([&] { load_scene(file, 1); }, ThrowsMessage<Error>(is_one_line_with_formats));
    EXPECT_THAT([&] { scene_content_hash(file); }, ThrowsMessage<Error>(is_one_line_with_formats));
}

// Runs in stores are named by it, so that it must never change.
TEST(SceneHash, StaysWhatItIs) {
    EXPECT_EQ(scene_content_hash(kScenes / "VeachMIS/VeachMIS.json"),
              "6075f143606e604dd69683e9e7edeea15176fb22655b71c09aeba7caf8549998");
    EXPECT_EQ(scene_content_hash(kScenes / "Box/LightTop.json"),
              "b0039baadf8f540975ea66a0d180a65d4c70b25a25e7b78c4c97183a932bce32");
    EXPECT_EQ(scene_content_hash(kScenes / "CornellBox/CornellBox.json"),
              "fb0a1600c43e54b63a3b92c5944149955daa944ed7e1b4966d306b64f71a4c85");
}

TEST(SceneHash, IsTheSameWhereverTheSceneLiesAndAnotherWhenAMeshChanges) {
    const TemporaryFolder folder;
    const auto copy = folder.path() / "elsewhere";
    fs::copy(kScenes / "VeachMIS", copy, fs::copy_options::recursive);
    const std::string hash = scene_content_hash(kScenes / "VeachMIS/VeachMIS.json");
    EXPECT_EQ(scene_content_hash(copy / "VeachMIS.json"), hash);
    std::ofstream(copy / "meshes/mesh3.ply", std::ios::app) << "x";
    EXPECT_NE(scene_content_hash(copy / "VeachMIS.json"), hash);
    fs::remove(copy / "meshes/mesh3.ply");
    EXPECT_THAT([&] { scene_content_hash(copy / "VeachMIS.json"); },
                ThrowsMessage<Error>(HasSubstr("mesh3.ply': no such file")));
}

TEST(SceneHash, ChangesWithEveryFileThatTheSceneRefersTo) {
    const TemporaryFolder folder;
    const fs::path scene = folder.write("s.json", R"({
        "background": {"type": "image", "filename": "sky.exr"},
        "materials": [{"name": "a", "baseColor": {"type": "image", "filename": "a b.png"}},
                      {"name": "b", "baseColor": {"type": "texture", "path": "b.png"},
                       "roughness": "r.png"}],
        "objects": [{"type": "ply", "relativePath": "m.ply"}]})");
    const std::vector<std::string> names = {"sky.exr", "a b.png", "b.png", "r.png", "m.ply"};
    for (const std::string& name : names) folder.write(name, "1");
    const std::string hash = scene_content_hash(scene);
    for (const std::string& name : names) {
        folder.write(name, "2");
        EXPECT_NE(scene_content_hash(scene), hash) << name;
        folder.write(name, "1");
    }
    EXPECT_EQ(scene_content_hash(scene), hash);
}

}  // namespace
}  // namespace misbench
