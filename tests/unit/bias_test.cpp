// Which method is biased where, and the comparison's test of itself, on stores of made-up runs.
#include "experiments/report/bias_formats.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "experiments/analysis/self_test.h"
#include "experiments/report/table_formats.h"
#include "tests/support/store_fixture.h"

namespace misbench {
namespace {

using testing::HasSubstr;

constexpr int kWidth = 48;
constexpr int kHeight = 40;

// Images around one; "clever" lacks `loss` of the light in the tile at (16, 8).
class BiasTest : public StoreTest {
 protected:
    static Plan plan(int n_seeds, Budget budget = SampleBudget{16}) {
        Plan plan = made_up_plan("first", n_seeds, budget);
        for (Cell& cell : plan.cells) {
            cell.task.width = kWidth;
            cell.task.height = kHeight;
        }
        return plan;
    }

    static void commit(Store& store, const Task& task, float loss) {
        Record record = made_up_record(task);
        record.statistics.passes = 4;
        const auto folder = store.stage(record.run, record.epoch);
        Image image = made_up_image(task);
        for (int y = 8; y < 16; ++y) {
            for (int x = 16; x < 24; ++x) {
                for (int c = 0; c < 3; ++c) {
                    float& value = image.rgb[static_cast<std::size_t>(3 * (y * kWidth + x) + c)];
                    if (task.method == "clever") value *= 1 - loss;
                }
            }
        }
        write_exr(folder / "image.exr", image);
        record.image_sha256 = sha256_hex(read_file(folder / "image.exr"));
        write_file_durably(folder / "record.json", record_to_json(record).dump(1));
        store.commit_run(folder);
    }

    Store filled(const Plan& plan, float loss) const {
        Store store = open();
        store.put_experiment(plan);
        for (const Cell& cell : plan.cells) commit(store, cell.task, loss);
        store.measure(plan);
        return store;
    }
};

TEST_F(BiasTest, IsFoundWhereItIs) {
    const Plan planned = plan(8);
    const Store store = filled(planned, 0.4F);
    const Bias bias = find_bias(store, planned, {});
    ASSERT_EQ(bias.cells.size(), 1U);
    const BiasCell& cell = bias.cells.front();
    EXPECT_EQ(cell.method, "clever");
    EXPECT_EQ(cell.n_seeds, 8);
    EXPECT_TRUE(cell.test->is_paired);
    EXPECT_EQ(cell.finding, BiasFinding::Biased);
    EXPECT_LT(cell.adjusted_p, 0.01);
    const TileDifference& tile = *cell.test->strongest();
    EXPECT_EQ(tile.tile, (PixelRect{16, 8, 24, 16}));
    EXPECT_NEAR(tile.first / tile.second, 0.6, 0.05);
    EXPECT_EQ(bias.metric, "relmse.eps0.01");
    // R is about one, so that 0.01 below it hardly counts.
    EXPECT_NEAR(cell.parts->bias_squared, 0.4 * 0.4 * 64 / (kWidth * kHeight), 1e-3);
    EXPECT_THAT(bias_to_json(bias), HasSubstr("\"bias_squared\": 0.00"));

    const Image map = bias_map(cell, cell.test->scales.front());
    const auto pixel = static_cast<std::size_t>(3 * (12 * kWidth + 20));
    EXPECT_EQ(map.rgb[pixel], 0);  // blue: too dark
    EXPECT_EQ(map.rgb[pixel + 2], 1);
    EXPECT_GT(map.rgb[0], 0.2);

    EXPECT_EQ(find_bias(store, planned, {.margin = 0.9}).cells.front().finding,
              BiasFinding::Negligible);

    EXPECT_THAT(to_text(bias_table(bias)), HasSubstr("x 16…23, y 8…15"));
    EXPECT_THAT(to_markdown(bias_table(bias)), HasSubstr("| biased \\*"));
    const auto json = nlohmann::json::parse(bias_to_json(bias));
    EXPECT_EQ(json["cells"][0]["scales"][0]["strongest"]["x0"], 16);
    EXPECT_THAT(bias_to_csv(bias), HasSubstr("Box,clever,biased,8,8,"));
}

// Tiles are black but for one in fifty, which is fifty times too bright; `light` of all that.
std::vector<TileSums> rare_images(int n, double light) {
    std::mt19937_64 random(11);
    std::bernoulli_distribution is_met(0.02);
    std::vector<TileSums> images;
    for (int i = 0; i < n; ++i) {
        TileSums& image = images.emplace_back(TileSums{.width = 96, .height = 96, .sums = {}});
        for (int tile = 0; tile < 144; ++tile) {
            image.sums.push_back(is_met(random) ? 64 * 50 * light : 0);
        }
    }
    return images;
}

// Against images of calm noise, and as `find_bias` decides for a single cell.
BiasFinding finding_against_calm(const std::vector<TileSums>& images) {
    std::mt19937_64 random(12);
    std::normal_distribution<double> noise(64, 6.4);
    std::vector<TileSums> calm = images;
    for (TileSums& image : calm) {
        for (double& sum : image.sums) sum = noise(random);
    }
    BiasCell cell;
    cell.test = test_tiles(images, calm, {});
    std::vector<BiasCell> cells{cell};
    decide(cells, 0.01);
    return cells.front().finding;
}

TEST(BiasFindings, DarkTilesOfAMethodOfRareSamplesAreNoProof) {
    EXPECT_EQ(finding_against_calm(rare_images(6, 1)), BiasFinding::DarkOrRare);
    // Calm light that is lost is.
    std::vector<TileSums> dim = rare_images(6, 0);
    for (TileSums& image : dim) std::ranges::fill(image.sums, 32);
    EXPECT_EQ(finding_against_calm(dim), BiasFinding::Biased);
    // So is light where there should be less, whatever else is rare.
    std::vector<TileSums> leaking = rare_images(6, 1);
    for (TileSums& image : leaking) image.sums[7] = 1000;
    EXPECT_EQ(finding_against_calm(leaking), BiasFinding::Biased);
}

TEST_F(BiasTest, IsNotFoundWhereThereIsNone) {
    const Plan planned = plan(8);
    const Store store = filled(planned, 0);
    EXPECT_EQ(find_bias(store, planned, {.margin = 1e-5}).cells.front().finding,
              BiasFinding::NotFound);
    const Bias wide = find_bias(store, planned, {.margin = 0.2});
    EXPECT_EQ(wide.cells.front().finding, BiasFinding::Equivalent);
    EXPECT_THAT(to_text(bias_table(wide)), HasSubstr("equivalent"));
}

TEST_F(BiasTest, OfAMethodAgainstAnother) {
    const Plan planned = plan(3);
    const Store store = filled(planned, 0);
    EXPECT_EQ(find_bias(store, planned, {.against = "clever"}).cells.front().method, "plain");
    EXPECT_EQ(
        message_of(Errc::InvalidArgument, [&] { find_bias(store, planned, {.against = "magic"}); }),
        "experiment 'first' has no method 'magic'; known: 'plain' 'clever'");
    EXPECT_EQ(
        message_of(Errc::InvalidArgument, [&] { find_bias(store, planned, {.budget = "3 spp"}); }),
        "experiment 'first' has no budget '3 spp'; known: '16 spp'");
}

TEST_F(BiasTest, OfTooFewSeedsIsNotGuessedAt) {
    const Plan planned = plan(2);
    const Store store = filled(planned, 0.4F);
    const Bias bias = find_bias(store, planned, {});
    EXPECT_EQ(bias.cells.front().finding, BiasFinding::NotEnoughSeeds);
    EXPECT_THAT(to_text(bias_table(bias)), HasSubstr("not enough seeds"));
    EXPECT_THAT(bias_to_csv(bias), HasSubstr("Box,clever,not enough seeds,2,2,,"));
}

// Seeds that only one of the two has are no pairs.
TEST_F(BiasTest, OfPairsLeavesOutHalfPairs) {
    const Plan planned = plan(5);
    Store store = open();
    store.put_experiment(planned);
    for (const Cell& cell : planned.cells) {
        if (cell.method != "plain" || cell.seed != 3) commit(store, cell.task, 0);
    }
    const BiasCell cell = find_bias(store, planned, {}).cells.front();
    EXPECT_EQ(cell.n_seeds, 4);
    EXPECT_EQ(cell.n_seeds_against, 4);
    EXPECT_TRUE(cell.test->is_paired);
}

TEST_F(BiasTest, OfFewPassesIsMarked) {
    const Plan planned = plan(3, TimeBudget{.seconds = 1, .clock = BudgetClock::Cpu});
    const Store store = filled(planned, 0);
    const Bias bias = find_bias(store, planned, {});
    EXPECT_TRUE(bias.cells.front().few_passes);
    EXPECT_THAT(to_text(bias_table(bias)), HasSubstr("†"));
}

TEST_F(BiasTest, OfTheSameImagesHasNothingToTest) {
    Plan planned = plan(3);
    for (Cell& cell : planned.cells) cell.task.method = "plain";
    const Store store = filled(planned, 0);
    const Bias bias = find_bias(store, planned, {});
    EXPECT_EQ(bias.cells.front().finding, BiasFinding::NothingToTest);
}

// A comparison of lognormal errors, all cells alike.
Comparison made_up_comparison(int n_cells, int n_seeds, double spread) {
    std::mt19937_64 random(5);
    std::lognormal_distribution<double> error(0, spread);
    Comparison comparison;
    comparison.experiment = "first";
    comparison.metric = "mse";
    for (int c = 0; c < n_cells; ++c) {
        ComparedCell cell;
        cell.scene = "scene " + std::to_string(c);
        cell.method = "plain";
        cell.budget = SampleBudget{16};
        cell.n_measured = n_seeds;
        for (int i = 0; i < n_seeds; ++i) {
            cell.values.push_back(error(random));
            cell.seeds.push_back(i);
        }
        comparison.cells.push_back(cell);
    }
    return comparison;
}

TEST(SelfTest, FindsNoDifferenceBetweenHalvesAndOneThatIsPlanted) {
    const SelfTest test = self_test(made_up_comparison(60, 20, 0.03));
    EXPECT_TRUE(test.passes());
    EXPECT_NEAR(test.alone.share, test.alpha, 0.02);
    EXPECT_LE(test.adjusted.share, test.alone.share);
    EXPECT_LT(test.alone.interval.low, test.alpha);
    EXPECT_GT(test.found_alone, 0.85);
    EXPECT_LE(test.found_adjusted, test.found_alone);
    EXPECT_GT(test.cells.front().power, test.cells.front().found_share - 0.1);
    EXPECT_LE(test.cells.front().n_needed.value(), 12);
}

TEST(SelfTest, PassesExactlyWhereTheShareMayBeAlpha) {
    SelfTest test;
    test.alone = {.share = 0.08, .interval = {.low = 0.04, .high = 0.2}};
    EXPECT_TRUE(test.passes());
    test.adjusted = {.share = 0.2, .interval = {.low = 0.06, .high = 0.3}};
    EXPECT_FALSE(test.passes());
}

TEST(SelfTest, OfFewerSeedsThanCanBeSplitSaysSo) {
    const SelfTest test = self_test(made_up_comparison(2, 5, 0.1));
    EXPECT_TRUE(test.cells.empty());
    EXPECT_EQ(test.skipped.front(), "scene 0, plain, 16 spp: 5 seeds");
}

}  // namespace
}  // namespace misbench
