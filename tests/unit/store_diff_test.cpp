// What two stores differ in: missing runs, images that are not reproduced, means.
#include <gmock/gmock.h>

#include "experiments/analysis/store_diff.h"
#include "tests/support/store_fixture.h"

namespace misbench {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

class StoreDiffTest : public testing::Test {
 protected:
    // `factor` on all tested images of "clever".
    Store make(const std::string& name, const Plan& plan, float factor = 1) const {
        Store store(temporary_.path() / name, Store::Access::ReadWrite);
        for (const Cell& cell : plan.cells) {
            const auto staged = stage_made_up_run(store, cell.task);
            if (cell.role == Role::Test && cell.method == "clever" && factor != 1) {
                Image image = made_up_image(cell.task);
                for (float& value : image.rgb) value *= factor;
                write_exr(staged / "image.exr", image);
                Record record = made_up_record(cell.task);
                record.image_sha256 = sha256_hex(read_file(staged / "image.exr"));
                record.provenance.build_id = "other";
                write_file_durably(staged / "record.json", record_to_json(record).dump());
            }
            store.commit_run(staged);
        }
        store.put_experiment(plan);
        store.measure(plan);
        return store;
    }

    const Plan plan_ = made_up_plan("first", 6);
    TemporaryFolder temporary_;
};

TEST_F(StoreDiffTest, OfEqualStoresIsNothing) {
    const StoreDiff diff = diff_stores(make("a", plan_), make("b", plan_), "", "");
    EXPECT_TRUE(diff.is_same());
    EXPECT_EQ(diff.n_equal_images, 14);
    ASSERT_THAT(diff.means, SizeIs(2));
    EXPECT_TRUE(diff.means[0].is_identical);
}

TEST_F(StoreDiffTest, NamesWhatIsMissing) {
    Plan fewer = plan_;
    std::erase_if(fewer.cells, [](const Cell& c) { return c.method == "clever" && c.seed > 4; });
    const Store a = make("a", plan_);
    Store b = make("b", fewer);
    b.put_experiment(made_up_plan("second", 1));
    const StoreDiff diff = diff_stores(a, b, "", "");
    EXPECT_FALSE(diff.is_same());
    EXPECT_THAT(diff.only_b, ElementsAre("second"));
    ASSERT_THAT(diff.runs_only_a, SizeIs(1));
    EXPECT_EQ(diff.runs_only_a.begin()->first.method, "clever");
    EXPECT_THAT(diff.runs_only_a.begin()->second, ElementsAre(5, 6));
    EXPECT_THAT(diff.runs_only_b, IsEmpty());
}

TEST_F(StoreDiffTest, CallsOtherImagesAtEqualSamplesAFailureAndSaysWhoseTheyAre) {
    const StoreDiff diff = diff_stores(make("a", plan_), make("b", plan_, 1.0001F), "", "");
    EXPECT_FALSE(diff.is_same());
    ASSERT_THAT(diff.images, SizeIs(6));
    EXPECT_TRUE(diff.images[0].must_be_equal);
    EXPECT_EQ(diff.images[0].a.provenance.build_id, "abc");
    EXPECT_EQ(diff.images[0].b.provenance.build_id, "other");
}

TEST_F(StoreDiffTest, ExpectsOtherImagesAtEqualTimeButNotOtherMeans) {
    const Plan timed = made_up_plan("first", 6, TimeBudget{2, BudgetClock::Cpu});
    const Store a = make("a", timed);
    const StoreDiff close = diff_stores(a, make("b", timed, 1.0001F), "", "");
    ASSERT_THAT(close.images, SizeIs(6));
    EXPECT_FALSE(close.images[0].must_be_equal);
    const StoreDiff far = diff_stores(a, make("c", timed, 3), "", "");
    ASSERT_THAT(far.means, SizeIs(2));
    EXPECT_FALSE(far.means[0].differs()) << "plain is the same";
    EXPECT_TRUE(far.means[1].differs());
    EXPECT_TRUE(far.means[1].is_paired);
    EXPECT_LT(far.means[1].ratio.value, 1);
    EXPECT_FALSE(far.is_same());
}

TEST_F(StoreDiffTest, TellsOtherTasksFromOtherImages) {
    Plan other = plan_;
    for (Cell& cell : other.cells) {
        if (cell.method == "clever") cell.task.method_version = 2;
    }
    const StoreDiff diff = diff_stores(make("a", plan_), make("b", other), "first", "mse");
    ASSERT_THAT(diff.tasks, SizeIs(1));
    EXPECT_EQ(diff.tasks.begin()->first.second, "method version 1, not 2");
    EXPECT_THAT(diff.tasks.begin()->second, ElementsAre(1, 2, 3, 4, 5, 6));
    EXPECT_THAT(diff.images, IsEmpty());
    EXPECT_FALSE(diff.is_same());
}

}  // namespace
}  // namespace misbench
