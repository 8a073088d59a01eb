#include "renderer/scene/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/base/error.h"
#include "tests/support/scenes.h"

namespace misbench {
namespace {

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

}  // namespace
}  // namespace misbench
