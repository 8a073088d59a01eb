// The images that a render keeps on its way: each is that of a shorter render, and the render is
// the same with and without them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/base/error.h"
#include "renderer/methods/render_loop.h"
#include "tests/support/scenes.h"

namespace misbench {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

const Scene& box() {
    static const Scene scene = [] {
        SceneDescription description = test::open_box();
        description.meshes.push_back(test::ceiling_lamp());
        description.materials.push_back(test::surface(DielectricMaterial({})));
        description.quadrics.push_back(test::ball({-0.35F, -0.55F, 0.1F}, 0.4F, 3));
        return Scene(std::move(description), 1);
    }();
    return scene;
}

struct Case {
    std::string name;
    std::string method;
    ParameterMap parameters;
};

std::int64_t n(std::int64_t value) { return value; }
std::string text(const char* value) { return value; }

// Every method, and each that changes its estimator while it renders: shrinks its radius, learns
// factors in passes that it keeps, drops, or renders before the image.
std::vector<Case> cases() {
    return {
        {"Path", "path", {}},
        {"Direct", "direct", {}},
        {"Light", "light", {}},
        {"Bdpt", "bdpt", {}},
        {"Photon", "photon", {}},
        {"Vcm", "vcm", {}},
        {"VcmProgressive", "vcm", {{"radius_shrink", 0.6}}},
        {"Variance", "vcm", {{"factors", text("variance")}}},
        {"VarianceOfThreePasses", "bdpt", {{"factors", text("variance")}, {"training", n(3)}}},
        {"VariancePrecomputed", "vcm", {{"factors", text("variance")}, {"precompute", n(2)}}},
        {"Correction", "vcm", {{"factors", text("correction")}}},
        {"CorrectionDropped",
         "vcm",
         {{"factors", text("correction")}, {"correction_keep", false}, {"training", n(2)}}},
        {"Correlation", "vcm", {{"factors", text("correlation")}}},
    };
}

RenderRequest request_of(const Case& what, std::int64_t samples, int threads) {
    return {.method = what.method,
            .parameters = what.parameters,
            .width = 21,
            .height = 13,
            .budget = SampleBudget{samples},
            .seed = 3,
            .threads = threads};
}

class SnapshotsOf : public testing::TestWithParam<Case> {};

TEST_P(SnapshotsOf, AreTheImagesOfShorterRenders) {
    for (const int threads : {1, 4}) {
        RenderRequest request = request_of(GetParam(), 9, threads);
        const RenderResult plain = render(box(), request);
        request.snapshots = SnapshotLadder{};
        const RenderResult result = render(box(), request);
        EXPECT_EQ(result.image, plain.image);
        EXPECT_EQ(result.description, plain.description);
        EXPECT_EQ(result.statistics.rays, plain.statistics.rays);

        std::vector<std::int64_t> kept;
        for (const std::int64_t samples : {1, 2, 4, 8}) {
            if (render(box(), request_of(GetParam(), samples, 1)).valid) kept.push_back(samples);
        }
        EXPECT_GE(kept.size(), 2U);
        ASSERT_EQ(result.snapshots.size(), kept.size());
        for (std::size_t i = 0; i < kept.size(); ++i) {
            const SnapshotStatistics& at = result.snapshots[i].statistics;
            EXPECT_EQ(at.samples, kept[i]);
            const RenderResult shorter = render(box(), request_of(GetParam(), at.samples, 1));
            EXPECT_EQ(result.snapshots[i].image, shorter.image) << at.samples;
            EXPECT_EQ(at.passes, shorter.statistics.passes);
            EXPECT_EQ(at.rays, shorter.statistics.rays);
            EXPECT_EQ(at.training_passes, shorter.statistics.training_passes);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Methods, SnapshotsOf, testing::ValuesIn(cases()),
                         [](const auto& test) { return test.param.name; });

RenderResult render_with(const SnapshotLadder& ladder, const Budget& budget) {
    RenderRequest request = request_of({"", "path", {}}, 1, 1);
    request.budget = budget;
    request.snapshots = ladder;
    return render(box(), request);
}

std::vector<std::int64_t> samples_of(const RenderResult& result) {
    std::vector<std::int64_t> samples;
    for (const Snapshot& snapshot : result.snapshots) {
        samples.push_back(snapshot.statistics.samples);
    }
    return samples;
}

TEST(Snapshots, AreTakenAtTheRungsOfTheLadderAndTheLastOneIsTheImageItself) {
    using testing::ElementsAre;
    EXPECT_THAT(samples_of(render_with({}, SampleBudget{8})), ElementsAre(1, 2, 4));
    EXPECT_THAT(samples_of(render_with({}, SampleBudget{9})), ElementsAre(1, 2, 4, 8));
    EXPECT_THAT(samples_of(render_with({.first = 3, .factor = 3}, SampleBudget{30})),
                ElementsAre(3, 9, 27));
    EXPECT_THAT(samples_of(render_with({.first = 2, .factor = 5}, SampleBudget{20})),
                ElementsAre(2, 10));
    EXPECT_THAT(samples_of(render_with({}, SampleBudget{1})), ElementsAre());
}

TEST(Snapshots, OfATimeBudgetAreTakenAfterPassesToo) {
    const RenderResult result = render_with({}, TimeBudget{0.1, BudgetClock::Cpu});
    ASSERT_GE(result.snapshots.size(), 2U);
    EXPECT_LT(result.snapshots.back().statistics.samples, result.statistics.passes);
    for (std::size_t i = 0; i < result.snapshots.size(); ++i) {
        EXPECT_EQ(result.snapshots[i].statistics.samples, std::int64_t{1} << i);
    }
}

TEST(Snapshots, SayWhatTheyHadCost) {
    const RenderResult result = render_with({}, SampleBudget{64});
    double wall = 0;
    std::int64_t rays = 0;
    for (const Snapshot& snapshot : result.snapshots) {
        EXPECT_GT(snapshot.statistics.wall_seconds, wall);
        EXPECT_GT(snapshot.statistics.rays, rays);
        wall = snapshot.statistics.wall_seconds;
        rays = snapshot.statistics.rays;
    }
    EXPECT_LT(wall, result.statistics.wall_seconds);
    EXPECT_LT(rays, result.statistics.rays);
}

TEST(Snapshots, RefuseALadderThatDoesNotRise) {
    EXPECT_THAT([] { render_with({.first = 1, .factor = 1}, SampleBudget{2}); },
                ThrowsMessage<Error>(HasSubstr("then 1 times as many")));
    EXPECT_THAT([] { render_with({.first = 0, .factor = 2}, SampleBudget{2}); },
                ThrowsMessage<Error>(HasSubstr("after 0 passes")));
}

}  // namespace
}  // namespace misbench
