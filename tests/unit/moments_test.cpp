// Moments of a cell's images: what they are, and that the files of a store are only a shortcut.
#include "results/moments.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "experiments/analysis/cell_images.h"
#include "tests/support/store_fixture.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

// Values that a naive sum of squares would lose.
std::vector<Image> noisy_images(int n) {
    std::mt19937 random(5);
    std::normal_distribution<double> noise(1000, 0.01);
    std::vector<Image> images;
    for (int i = 0; i < n; ++i) {
        images.emplace_back(3, 2);
        for (float& value : images.back().rgb) value = static_cast<float>(noise(random));
    }
    return images;
}

MomentSums sums_of(std::span<const Image> images) {
    MomentSums sums;
    for (const Image& image : images) sums.add(image);
    return sums;
}

TEST(Moments, AreTheMeanAndTheSquaredDistancesFromIt) {
    const std::vector<Image> images = noisy_images(7);
    const PixelMoments moments = sums_of(images).moments();
    EXPECT_EQ(moments.n, 7);
    for (std::size_t i = 0; i < moments.mean.rgb.size(); ++i) {
        double mean = 0;
        for (const Image& image : images) mean += double{image.rgb[i]} / 7;
        double m2 = 0;
        for (const Image& image : images)
            m2 += (double{image.rgb[i]} - mean) * (double{image.rgb[i]} - mean);
        EXPECT_FLOAT_EQ(moments.mean.rgb[i], static_cast<float>(mean));
        EXPECT_NEAR(moments.m2.rgb[i], m2, 1e-6 * m2);
    }
}

TEST(Moments, MergedAreThoseOfAllImages) {
    const std::vector<Image> images = noisy_images(9);
    const PixelMoments all = sums_of(images).moments();
    for (const std::size_t n_first : {0U, 1U, 4U, 9U}) {
        MomentSums first = sums_of(std::span(images).first(n_first));
        first.merge(sums_of(std::span(images).subspan(n_first)));
        const PixelMoments merged = first.moments();
        EXPECT_EQ(merged.n, 9);
        EXPECT_EQ(merged.mean, all.mean);
        for (std::size_t i = 0; i < all.m2.rgb.size(); ++i) {
            EXPECT_NEAR(merged.m2.rgb[i], all.m2.rgb[i], 1e-6F * all.m2.rgb[i]);
        }
    }
}

class MomentsTest : public StoreTest {
 protected:
    fs::path moments_folder() const { return folder() / "moments"; }
    std::vector<std::string> files() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(moments_folder())) {
            names.push_back(entry.path().filename().string());
        }
        return names;
    }
    std::vector<CellRun> runs_of(const Store& store, const std::string& method) const {
        return finished_runs(store, plan_, "Box", method, SampleBudget{16});
    }
    static std::vector<std::string> ids(const std::vector<CellRun>& runs) {
        std::vector<std::string> ids;
        for (const CellRun& run : runs) ids.push_back(run.run);
        return ids;
    }
};

TEST_F(MomentsTest, OfEachCellAreMadeWhenItIsMeasuredAndGoWhenNoCellAsksForThem) {
    Store store = open();
    store.put_experiment(plan_);
    for (const Cell& cell : plan_.cells) {
        if (cell.seed == 3) continue;
        if (cell.method == "clever" && cell.seed == 2) {
            commit_made_up_run(store, cell.task, [](Record& record) { record.valid = false; });
        } else {
            commit_made_up_run(store, cell.task);
        }
    }
    store.measure(plan_);
    const std::vector<std::string> of_two = files();
    EXPECT_EQ(of_two.size(), 1U) << "one valid seed has no moments";
    EXPECT_EQ(store.moments(ids(runs_of(store, "plain"))).n, 2);

    const auto before = fs::last_write_time(moments_folder() / of_two[0]);
    store.measure(plan_);
    EXPECT_THAT(files(), ElementsAre(of_two[0]));
    EXPECT_EQ(fs::last_write_time(moments_folder() / of_two[0]), before);

    for (const Cell& cell : plan_.cells) {
        if (cell.seed == 3) commit_made_up_run(store, cell.task);
    }
    store.measure(plan_);
    EXPECT_EQ(files().size(), 2U);
    EXPECT_THAT(files(), testing::Not(testing::Contains(of_two[0])));
}

TEST_F(MomentsTest, AreTheSameFromTheFileAndFromTheRuns) {
    Store store = open();
    store.put_experiment(plan_);
    commit_all(store, plan_);
    const std::vector<CellRun> runs = runs_of(store, "plain");
    const std::vector<CellRun> backwards(runs.rbegin(), runs.rend());
    const Image computed = mean_image(store, runs).value();
    const Image spread = standard_error_image(store, runs).value();
    store.measure(plan_);
    EXPECT_EQ(files().size(), 2U);
    EXPECT_EQ(mean_image(store, runs), computed);
    EXPECT_EQ(standard_error_image(store, backwards), spread);
    // One pixel by hand: s/√n with n - 1 degrees of freedom.
    double sum = 0;
    double squares = 0;
    for (const CellRun& run : runs) {
        const double value = store.run_image(run.run).rgb[5];
        sum += value;
        squares += value * value;
    }
    EXPECT_NEAR(spread.rgb[5], std::sqrt((squares - sum * sum / 3) / 2 / 3), 1e-6);
    EXPECT_FALSE(standard_error_image(store, {runs[0]}).has_value());
}

TEST_F(MomentsTest, AreNotBelievedFromAFileOfOtherRunsOrADamagedOne) {
    Store store = open();
    store.put_experiment(plan_);
    commit_all(store, plan_);
    store.measure(plan_);
    const Image truth = mean_image(store, runs_of(store, "plain")).value();
    const std::vector<std::string> names = files();
    fs::copy_file(moments_folder() / names[0], moments_folder() / names[1],
                  fs::copy_options::overwrite_existing);
    EXPECT_EQ(mean_image(store, runs_of(store, "plain")), truth);
    EXPECT_NE(mean_image(store, runs_of(store, "clever")), truth);
    for (const std::string& name : names) write_file_durably(moments_folder() / name, "nothing");
    EXPECT_EQ(mean_image(store, runs_of(store, "plain")), truth);
    fs::remove_all(moments_folder());
    EXPECT_EQ(mean_image(store, runs_of(store, "plain")), truth);
}

TEST(ExrLayers, ComeBackByTheirNamesWithTheAttributes) {
    const TemporaryFolder folder;
    const std::vector<Image> images = noisy_images(2);
    const fs::path path = folder.path() / "two.exr";
    write_exr_layers(path, std::array{ImageLayer{"", &images[0]}, ImageLayer{"m2", &images[1]}},
                     {{"runs", "a b"}});
    const ExrLayers layers = read_exr_layers(path, std::vector<std::string>{"m2", ""});
    EXPECT_THAT(layers.images, ElementsAre(NamedImage{"m2", images[1]}, NamedImage{"", images[0]}));
    const ExrLayers all = read_exr_layers(path);
    EXPECT_THAT(all.images, ElementsAre(NamedImage{"", images[0]}, NamedImage{"m2", images[1]}));
    EXPECT_EQ(layers.attributes.at("runs"), "a b");
    EXPECT_THAT(
        message_of(Errc::DataLoss, [&] { read_exr_layers(path, std::vector<std::string>{"m3"}); }),
        HasSubstr("it has no float channel m3.R"));
}

}  // namespace
}  // namespace misbench
