// On all scenes of experiments/scenes, all estimators that find all light have the same expected
// image. What each finds is in tests/support/estimators.cpp. Their lamps are too small for those
// that meet lights by chance only.
#include <gtest/gtest.h>

#include "renderer/scene/load.h"
#include "tests/support/expect_agreement.h"
#include "tests/support/statistics.h"

namespace misbench {
namespace {

// One false alarm among all scenes with less than this probability.
constexpr double kAlpha = 0.01;
constexpr int kSeeds = 16;
// A bias of the whole image that must be found.
constexpr double kDetectableBias = 0.2;

const std::vector<SceneListing>& scenes() {
    static const std::vector<SceneListing> kListed = list_scenes(MISBENCH_SCENES);
    return kListed;
}

// Lamps that are seen, smaller than a pixel and far brighter than all else, drown the rest of the
// image in their noise. Paths of one edge are the same by all estimators.
int fewest_edges(const std::string& scene) { return scene == "veach-mis" ? 2 : 1; }

class EverySceneOfThePack : public testing::TestWithParam<std::size_t> {};

TEST_P(EverySceneOfThePack, LooksTheSameByAllEstimators) {
    const SceneListing& listing = scenes()[GetParam()];
    const LoadedScene loaded = load_scene(listing.file, 2);
    test::expect_agreement(
        *loaded.scene,
        {.lengths = {fewest_edges(listing.name), 6}, .width = 48, .height = 32, .samples = 6},
        {.scene = listing.name,
         .n_seeds = kSeeds,
         .false_discovery_rate = test::sidak(kAlpha, static_cast<int>(scenes().size()))},
        kDetectableBias);
}

INSTANTIATE_TEST_SUITE_P(Pack, EverySceneOfThePack, testing::Range(std::size_t{0}, scenes().size()),
                         [](const auto& test) {
                             std::string name = scenes()[test.param].name;
                             for (char& c : name) {
                                 if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
                             }
                             return name;
                         });

}  // namespace
}  // namespace misbench
