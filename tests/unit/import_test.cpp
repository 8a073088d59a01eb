// Images of other renderers in a store: of equal standing, kept, and refused where they do not fit.
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <limits>

#include "experiments/plan/imported.h"
#include "results/import.h"
#include "results/metrics/metrics.h"
#include "tests/support/store_fixture.h"

namespace misbench {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// A writer changes the database's header even where it writes nothing.
std::map<std::string, std::string> files_of(const std::filesystem::path& store) {
    auto files = hashes_below(store);
    files.erase("results.sqlite");
    return files;
}

class Import : public StoreTest {
 protected:
    // An image that no other seed has.
    std::filesystem::path image(const std::string& name, float value, int width = 8) const {
        Image pixels(width, 4);
        for (std::size_t i = 0; i < pixels.rgb.size(); ++i) {
            pixels.rgb[i] = value + 0.01F * static_cast<float>(i % 7);
        }
        write_exr(files_.path() / name, pixels);
        return files_.path() / name;
    }

    ImageToImport mine(std::int64_t seed, float value = 2) const {
        return {
            .file = image("mine" + std::to_string(seed) + ".exr", value + static_cast<float>(seed)),
            .scene = "Box",
            .method = "mine",
            .seed = seed,
            .budget = SampleBudget{16},
            .renderer = "Other 1.0"};
    }

    ImageToImport half(std::int64_t seed, const std::string& scene = "Box") const {
        return {.file = image("half" + std::to_string(seed) + ".exr", static_cast<float>(seed)),
                .scene = scene,
                .method = kReferenceLabel,
                .seed = seed};
    }

    Imported import(const std::vector<ImageToImport>& images, bool replace = false) const {
        return import_images(folder(),
                             {.experiment = "first", .images = images, .replace = replace});
    }

    void expect_refused(const std::vector<ImageToImport>& images, const std::string& why) const {
        const std::string message = message_of(Errc::InvalidArgument, [&] { import(images); });
        EXPECT_THAT(message, AllOf(HasSubstr("import "), HasSubstr(why)));
    }

    void make_rendered_store() const {
        Store store = open();
        commit_all(store, plan_);
        store.put_experiment(plan_);
        store.measure(plan_);
    }

    const TemporaryFolder files_;
};

TEST_F(Import, StandsBesideTheMethodsThatAreRendered) {
    make_rendered_store();
    const Imported imported = import({mine(1), mine(2), mine(3)});
    EXPECT_EQ(imported.n_new, 3);
    EXPECT_EQ(imported.n_measured, 6);
    const Store store = open(Store::Access::ReadOnly);
    const Plan plan = store.experiment("first");
    EXPECT_EQ(plan, imported.plan);
    EXPECT_THAT(plan.methods, ElementsAre("plain", "clever", "mine"));
    EXPECT_EQ(plan.baseline, "plain");
    EXPECT_THAT(plan.cells, SizeIs(plan_.cells.size() + 3));
    for (const Cell& cell : plan.cells) {
        EXPECT_EQ(store.task(task_id(cell.task))->state, TaskState::Done);
    }

    const Cell& cell = *std::ranges::find(plan.cells, "mine", &Cell::method);
    const std::string id = task_id(cell.task);
    EXPECT_EQ(store.run_image(id), read_exr(files_.path() / "mine1.exr"));
    const Record record = store.run(id).value();
    EXPECT_TRUE(record.valid);
    EXPECT_EQ(record.statistics.passes, 16);
    EXPECT_EQ(record.provenance.build_id, "Other 1.0");
    EXPECT_THAT(record.description, HasSubstr("mine1.exr"));
    const auto measured = store.measurements(plan);
    const auto of_run = std::ranges::find_if(
        measured, [&id](const Measurement& m) { return m.run == id && m.metric == "mse"; });
    ASSERT_NE(of_run, measured.end());
    const Image a = store.run_image(of_run->reference_a);
    const Image b = store.run_image(of_run->reference_b);
    EXPECT_EQ(of_run->value, measure(find_metric("mse"), store.run_image(id), {a, b}));
}

TEST_F(Import, MakesStoreAndExperiment) {
    const Imported imported = import({mine(2), mine(1), half(11), half(12)});
    EXPECT_EQ(imported.n_measured, 2);
    const Plan& plan = imported.plan;
    EXPECT_EQ(plan.baseline, "mine");
    EXPECT_THAT(plan.metrics, ElementsAre("relmse.eps0.01"));
    ASSERT_THAT(plan.cells, SizeIs(4));
    EXPECT_EQ(plan.cells[0].role, Role::ReferenceA);
    EXPECT_EQ(plan.cells[1].role, Role::ReferenceB);
    EXPECT_EQ(plan.cells[2].seed, 1);
    EXPECT_EQ(plan.cells[3].seed, 2);
}

TEST_F(Import, TwiceChangesNothing) {
    import({mine(1), half(11), half(12)});
    const auto before = files_of(folder());
    const Imported again = import({mine(1), half(11), half(12)});
    EXPECT_EQ(again.n_new, 0);
    EXPECT_EQ(again.n_known, 3);
    EXPECT_EQ(again.n_measured, 0);
    EXPECT_EQ(files_of(folder()), before);
}

TEST_F(Import, IsReplacedOnlyWhenAskedAndTheOldRunStays) {
    const Plan before = import({mine(1)}).plan;
    expect_refused({mine(1, 7)}, "--replace");
    ImageToImport slower = mine(1);
    slower.cpu_seconds = 3;
    expect_refused({slower}, "Box, mine, 16 spp, seed 1");
    const Plan after = import({mine(1, 7)}, true).plan;
    ASSERT_THAT(after.cells, SizeIs(1));
    EXPECT_NE(after.cells[0].task, before.cells[0].task);
    EXPECT_TRUE(open().has_run(task_id(before.cells[0].task)));
}

TEST_F(Import, IsKeptWhenTheExperimentIsRunAgain) {
    make_rendered_store();
    import({mine(1), mine(2), mine(3)});
    Store store = open();
    store.put_experiment(made_up_plan("first", 5));
    const Plan plan = store.experiment("first");
    EXPECT_THAT(plan.methods, ElementsAre("plain", "clever", "mine"));
    EXPECT_THAT(plan.cells, SizeIs(2 + 3 * 2 + 2 * 2 + 3));
    EXPECT_TRUE(std::ranges::is_sorted(plan.cells.begin() + 2, plan.cells.end(), {}, &Cell::seed));
}

TEST_F(Import, IsLeftOutWhereTheSceneIsAnotherOneNow) {
    make_rendered_store();
    const Plan with = import({mine(1)}).plan;
    Plan changed = plan_;
    for (Cell& cell : changed.cells) cell.task.scene_hash = "another";
    EXPECT_THAT(keep_imported(changed, with), ElementsAre(HasSubstr("the scene has changed")));
    EXPECT_THAT(changed.cells, SizeIs(plan_.cells.size()));
    Plan larger = plan_;
    for (Cell& cell : larger.cells) cell.task.width = 16;
    EXPECT_THAT(keep_imported(larger, with), ElementsAre(HasSubstr("8x4 pixels")));
    Plan same_label = plan_;
    for (Cell& cell : same_label.cells) cell.method = cell.method == "plain" ? "mine" : cell.method;
    EXPECT_THAT(message_of(Errc::InvalidArgument, [&] { keep_imported(same_label, with); }),
                HasSubstr("'mine' is one that misbench renders"));
}

TEST_F(Import, IsRemovedWithWhatNothingIsLeftOfAndNothingElse) {
    make_rendered_store();
    ImageToImport other = mine(1, 5);
    other.method = "theirs";
    other.budget = SampleBudget{64};
    import({mine(1), mine(2), other});
    const Plan with = open().experiment("first");
    EXPECT_EQ(remove_images(folder(), "first", "mine", ""), 2);
    {
        const Store store = open(Store::Access::ReadOnly);
        const Plan plan = store.experiment("first");
        EXPECT_THAT(plan.methods, ElementsAre("plain", "clever", "theirs"));
        EXPECT_EQ(plan.budgets, with.budgets);
        EXPECT_THAT(plan.cells, SizeIs(plan_.cells.size() + 1));
        EXPECT_THAT(plan.configuration, testing::Not(HasSubstr("mine")));
        EXPECT_THAT(store.measurements(plan), SizeIs(2 * (2 * 3 + 1)));
    }
    EXPECT_EQ(remove_images(folder(), "first", "theirs", "Box"), 1);
    EXPECT_EQ(open().experiment("first").budgets, plan_.budgets);
    EXPECT_EQ(open().experiment("first").cells, plan_.cells);
    // The runs stay: what is imported again is there.
    EXPECT_EQ(import({mine(1), mine(2), other}).n_known, 3);
}

TEST_F(Import, IsNotRemovedByAnotherName) {
    make_rendered_store();
    import({mine(1)});
    const auto before = files_of(folder());
    const auto refused = [&](const std::string& label, const std::string& scene) {
        return message_of(Errc::InvalidArgument,
                          [&] { remove_images(folder(), "first", label, scene); });
    };
    EXPECT_THAT(refused("plain", ""), HasSubstr("'plain' is one that misbench renders"));
    EXPECT_THAT(refused("min", ""), HasSubstr("unknown imported method 'min'"));
    EXPECT_THAT(refused("mine", "Bax"), HasSubstr("unknown scene 'Bax'"));
    EXPECT_EQ(files_of(folder()), before);
    EXPECT_THAT(message_of(Errc::NotFound,
                           [&] { remove_images(files_.path() / "none", "first", "mine", ""); }),
                HasSubstr("no results.sqlite"));
    EXPECT_FALSE(std::filesystem::exists(files_.path() / "none"));
}

TEST_F(Import, TakesALayerOfAFileThatHasSome) {
    Image beauty(8, 4);
    std::ranges::fill(beauty.rgb, 3.0F);
    const Image albedo(8, 4);
    const auto file = files_.path() / "layers.exr";
    write_exr_layers(
        file, std::array{ImageLayer{"albedo", &albedo}, ImageLayer{"View.Combined", &beauty}});
    ImageToImport image = mine(1);
    image.file = file;
    const auto import_layer = [&](const std::string& layer) {
        return import_images(folder(), {.experiment = "first", .images = {image}, .layer = layer});
    };
    EXPECT_THAT(message_of(Errc::InvalidArgument, [&] { import_layer(""); }),
                HasSubstr("known: R G B, or Y, and A; its layers: View.Combined albedo"));
    EXPECT_THAT(message_of(Errc::InvalidArgument, [&] { import_layer("Combined"); }),
                HasSubstr("no layer 'Combined' of R G B or Y; its layers: View.Combined albedo"));
    const Plan plan = import_layer("View.Combined").plan;
    EXPECT_EQ(open().run_image(task_id(plan.cells[0].task)), beauty);
}

TEST_F(Import, BeforeTheFirstRunOfTheFileIsKeptToo) {
    import({mine(1), half(11), half(12)});
    Store store = open();
    commit_all(store, plan_);
    store.put_experiment(plan_);
    const Plan plan = store.experiment("first");
    EXPECT_THAT(plan.methods, ElementsAre("plain", "clever", "mine"));
    EXPECT_THAT(plan.cells, SizeIs(plan_.cells.size() + 1)) << "the file's reference counts";
    EXPECT_EQ(store.measure(plan), 14);
}

TEST_F(Import, WithPixelsThatAreNotFiniteIsInvalid) {
    Image pixels(8, 4);
    pixels.rgb[3 * 10 + 1] = std::numeric_limits<float>::quiet_NaN();
    pixels.rgb[3 * 20] = std::numeric_limits<float>::infinity();
    pixels.rgb[3 * 21] = -1;
    write_exr(files_.path() / "bad.exr", pixels);
    ImageToImport bad = mine(1);
    bad.file = files_.path() / "bad.exr";
    const Imported imported = import({bad, half(11), half(12)});
    EXPECT_THAT(imported.invalid, ElementsAre(HasSubstr("2 pixels are not finite")));
    EXPECT_EQ(imported.n_measured, 0);
    const Store store = open(Store::Access::ReadOnly);
    const Record record = store.run(task_id(imported.plan.cells.back().task)).value();
    EXPECT_FALSE(record.valid);
    EXPECT_EQ(record.statistics.nonfinite_samples, 2);
    EXPECT_EQ(record.statistics.negative_samples, 1);
    EXPECT_EQ(record.statistics.first_bad_sample, (SamplePlace{.x = 2, .y = 1, .pass = 0}));
}

TEST_F(Import, NeedsTwoIndependentHalves) {
    expect_refused({mine(1), half(11)}, "two independent halves are needed");
    expect_refused({half(11), half(12), half(13)}, "3 images");
    ImageToImport copy = half(12);
    copy.file = half(11).file;
    expect_refused({half(11), copy}, "the same image");
    const Imported one = import_images(
        folder(), {.experiment = "first", .images = {mine(1), half(11)}, .one_reference = true});
    EXPECT_EQ(one.n_new, 2);
    EXPECT_EQ(one.n_measured, 1);
    EXPECT_EQ(one.plan.cells[0].task, one.plan.cells[1].task);
}

TEST_F(Import, RefusesWhatDoesNotFitAndMakesNothing) {
    ImageToImport without_budget = mine(1);
    without_budget.budget.reset();
    expect_refused({without_budget}, "samples or seconds");
    ImageToImport larger = mine(2);
    larger.file = image("larger.exr", 1, 16);
    expect_refused({mine(1), larger}, "images of scene 'Box' have 8x4 pixels, this one 16x4");
    ImageToImport again = mine(1);
    again.file = image("again.exr", 9);
    expect_refused({mine(1), again}, "mine1.exr' has the same scene, method, seed and budget");
    ImageToImport png = mine(1);
    png.file = files_.write("image.png", encode_png(Image(8, 4), 0));
    expect_refused({png}, "integers");
    png.file = files_.write("broken.exr", "no image");
    expect_refused({png}, "broken.exr");
    EXPECT_FALSE(std::filesystem::exists(folder()));
}

TEST_F(Import, RefusesWhatARenderedExperimentDoesNotHave) {
    make_rendered_store();
    const auto before = files_of(folder());
    ImageToImport other = mine(1);
    other.scene = "Bax";
    expect_refused({other}, "unknown scene 'Bax' (did you mean 'Box'?)");
    other = mine(1);
    other.method = "plain";
    expect_refused({other}, "'plain' is one that misbench renders");
    expect_refused({half(11), half(12)}, "reference_a of scene 'Box' is one that misbench renders");
    EXPECT_EQ(files_of(folder()), before);
}

TEST_F(Import, IsFoundAgainByReindex) {
    const Plan plan = import({mine(1), mine(2), half(11), half(12)}).plan;
    const auto before = open().measurements(plan);
    std::filesystem::remove(folder() / "results.sqlite");
    reindex(folder());
    const Store store = open();
    EXPECT_EQ(store.experiment("first"), plan);
    ASSERT_THAT(store.measurements(plan), SizeIs(before.size()));
    EXPECT_EQ(store.measurements(plan)[0].value, before[0].value);
}

}  // namespace
}  // namespace misbench
