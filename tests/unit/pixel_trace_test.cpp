#include "renderer/paths/pixel_trace.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/made_up_samples.h"

namespace misbench {
namespace {

using testing::ElementsAre;

std::vector<float> places(const KeptSample& sample) {
    std::vector<float> x;
    for (const PathVertex& vertex : sample.vertices) x.push_back(vertex.point.position.x);
    return x;
}

TEST(PixelTrace, KeepsTheSamplesOfItsPixelByPhaseAndChunk) {
    PixelTrace trace({3, 2});
    const auto show = [&trace](Pixel pixel, float red, std::size_t chunk) {
        trace.observe(
            test::MadeUpSample(pixel, 3, {TechniqueKind::NextEvent}, {red, 0, 0}, 0.5).sample,
            chunk);
    };
    trace.start_phase(3);
    show({3, 2}, 3, 2);
    show({2, 3}, 99, 2);
    show({3, 2}, 1, 0);
    show({3, 2}, 2, 0);
    trace.finish_phase();
    trace.start_phase(1);
    show({3, 2}, 4, 0);
    trace.finish_phase();
    std::vector<float> reds;
    for (const KeptSample& sample : trace.samples()) reds.push_back(sample.value.r);
    EXPECT_THAT(reds, ElementsAre(1, 2, 3, 4));
}

TEST(PixelTrace, KeepsAllOfASampleBeyondItsEvent) {
    PixelTrace trace({});
    trace.start_phase(1);
    for (const Technique technique :
         {Technique{TechniqueKind::Hit}, Technique{TechniqueKind::Light},
          Technique{TechniqueKind::Connect, 2}, Technique{TechniqueKind::Merge, 3}}) {
        test::MadeUpSample made_up({}, 4, technique, {1, 2, 3}, 0.25);
        made_up.densities.make_room(9);
        made_up.densities.merge_area = 7;
        const std::vector<double> factors(8, 0.5);
        made_up.sample.factors = factors;
        trace.observe(made_up.sample, 0);
    }
    trace.finish_phase();
    ASSERT_EQ(trace.samples().size(), 4U);
    for (const KeptSample& sample : trace.samples()) {
        EXPECT_THAT(places(sample), ElementsAre(1, 2, 3, 4));
        EXPECT_THAT(sample.densities.from_camera, ElementsAre(0, 10, 20, 30, 40));
        EXPECT_THAT(sample.densities.from_light, ElementsAre(0, 20, 40, 60, 80));
        EXPECT_EQ(sample.densities.merge_area, 7);
        EXPECT_EQ(sample.q.size(), 8U);
        EXPECT_EQ(sample.q[static_cast<std::size_t>(sample.technique.index(4))], 1);
        EXPECT_EQ(sample.factors, std::vector<double>(8, 0.5));
        EXPECT_EQ(sample.value, (Rgb{1, 2, 3}));
        EXPECT_EQ(sample.weight, 0.25);
        EXPECT_EQ(sample.photon.has_value(), sample.technique.kind == TechniqueKind::Merge);
    }
    EXPECT_EQ(trace.samples()[3].photon->point.position.x, 3);
}

}  // namespace
}  // namespace misbench
