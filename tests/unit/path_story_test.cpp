#include "experiments/cli/path_story.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "tests/support/scenes.h"

namespace misbench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A light that is seen directly.
KeptSample seen(Rgb value, double weight) {
    KeptSample sample{.value = value, .weight = weight, .q = {1}};
    sample.densities.make_room(1);
    sample.densities.n_edges = 1;
    sample.vertices.resize(1);
    sample.vertices[0].point.light = 0;
    return sample;
}

TEST(PathStory, BeginsWithWhatMattersMost) {
    std::vector<float> reds;
    for (const KeptSample& sample : by_weighted_value(
             {seen({1, 0, 0}, 0.5), seen({2, 0, 0}, 0.5), seen({3, 0, 0}, 0.1),
              seen({4, 0, 3}, 1.0 / 4), seen({5, 0, std::nanf("")}, 1), seen({-6, 0, 0}, 1)})) {
        reds.push_back(sample.value.r);
    }
    EXPECT_THAT(reds, ElementsAre(5, -6, 2, 4, 1, 3));
}

TEST(PathStory, SumsWeightedValuesInDouble) {
    const std::vector<KeptSample> samples{seen({1, 2, 4}, 0.5), seen({1, 0, 0}, 1e-12)};
    EXPECT_EQ(weighted_sum(samples), (RgbSum{0.5 + 1e-12, 1, 2}));
}

TEST(PathStory, ShowsWhatIsNotFinite) {
    const Scene scene(test::furnace(DiffuseMaterial{{0.5F, 0.5F, 0.5F}}, {1, 1, 1}), 1);
    const std::vector<KeptSample> samples{seen({kInfinity, -kInfinity, std::nanf("")}, 1)};
    EXPECT_THAT(story_to_text(samples, scene), HasSubstr("weight 1 · value inf -inf nan = inf"));
    EXPECT_EQ(story_to_json(samples, scene)[0]["value"],
              nlohmann::ordered_json({"inf", "-inf", "nan"}));
}

}  // namespace
}  // namespace misbench
