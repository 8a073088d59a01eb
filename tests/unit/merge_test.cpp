// Merging stores: the halves are the whole, in any order, however often, and nothing is lost.
#include <gmock/gmock.h>

#include "experiments/plan/task_difference.h"
#include "experiments/plan/unite.h"
#include "results/merge.h"
#include "tests/support/store_fixture.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
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

// Of the made up plan the cells with these seeds, and the reference.
Plan part_of(Plan plan, std::int64_t from, std::int64_t to) {
    std::erase_if(plan.cells, [&](const Cell& cell) {
        return cell.role == Role::Test && (cell.seed < from || cell.seed > to);
    });
    return plan;
}

class Merge : public testing::Test {
 protected:
    fs::path make(const std::string& name, const std::vector<Plan>& plans,
                  const RecordChange& change = {}) const {
        Store store(path(name), Store::Access::ReadWrite);
        for (const Plan& plan : plans) {
            for (const Cell& cell : plan.cells) commit_made_up_run(store, cell.task, change);
            store.put_experiment(plan);
            store.measure(plan);
        }
        return path(name);
    }
    fs::path path(const std::string& name) const { return temporary_.path() / name; }

    static std::map<std::string, double> values(const fs::path& folder, const Plan& plan) {
        std::map<std::string, double> values;
        for (const Measurement& m : Store(folder, Store::Access::ReadOnly).measurements(plan)) {
            values[m.run + m.reference_a + m.reference_b + m.metric] = m.value;
        }
        return values;
    }
    static Plan plan_in(const fs::path& folder) {
        return Store(folder, Store::Access::ReadOnly).experiment("first");
    }

    const Plan plan_ = made_up_plan("first", 4);
    const Plan low_ = part_of(plan_, 1, 2);
    const Plan high_ = part_of(plan_, 3, 4);
    TemporaryFolder temporary_;
};

TEST_F(Merge, OfTwoHalvesIsTheWholeInAnyOrder) {
    const fs::path whole = make("whole", {plan_});
    const fs::path low = make("low", {low_});
    const fs::path high = make("high", {high_});
    const auto low_before = hashes_below(low);
    const auto high_before = hashes_below(high);
    const Merged merged = merge_stores(path("a"), {low, high}, false);
    EXPECT_EQ(merged.n_runs, 10);
    EXPECT_EQ(merged.n_known, 2) << "the reference";
    merge_stores(path("b"), {high, low}, false);
    for (const fs::path& folder : {path("a"), path("b")}) {
        EXPECT_EQ(plan_in(folder), plan_);
        EXPECT_EQ(values(folder, plan_), values(whole, plan_));
    }
    EXPECT_EQ(hashes_below(low), low_before);
    EXPECT_EQ(hashes_below(high), high_before);
}

TEST_F(Merge, AgainChangesNothing) {
    const fs::path low = make("low", {low_});
    const fs::path high = make("high", {high_, made_up_plan("second", 1)});
    merge_stores(low, {high}, false);
    const auto before = files_of(low);
    const Merged again = merge_stores(low, {high}, false);
    EXPECT_EQ(again.n_runs, 0);
    EXPECT_EQ(again.n_measured, 0);
    EXPECT_THAT(again.experiments, IsEmpty());
    EXPECT_EQ(files_of(low), before);
}

TEST_F(Merge, GoesOnWhereItWasInterrupted) {
    const fs::path high = make("high", {high_});
    {
        // What is there when a merge ends in the middle: some runs, and a copy that is not whole.
        Store store(path("low"), Store::Access::ReadWrite);
        commit_made_up_run(store, high_.cells[0].task);
        stage_made_up_run(store, high_.cells[1].task);
    }
    EXPECT_EQ(Store(path("low"), Store::Access::ReadOnly).run_summaries().size(), 1);
    const Merged merged = merge_stores(path("low"), {high}, false);
    EXPECT_EQ(merged.n_known, 1);
    EXPECT_EQ(plan_in(path("low")), plan_in(high));
    EXPECT_EQ(values(path("low"), high_), values(high, high_));
}

TEST_F(Merge, RefusesAnotherExperimentOfTheSameNameAndCopiesNothing) {
    Plan other = high_;
    for (Cell& cell : other.cells) cell.task.parameters["max_depth"] = std::int64_t{6};
    const fs::path low = make("low", {low_});
    const fs::path high = make("high", {other});
    const auto before = files_of(low);
    EXPECT_THAT(message_of(Errc::InvalidArgument, [&] { merge_stores(low, {high}, false); }),
                AllOf(HasSubstr("experiment 'first'"), HasSubstr("parameter max_depth 3, not 6"),
                      HasSubstr("--rename")));
    EXPECT_EQ(files_of(low), before);
    EXPECT_THAT(merge_stores(low, {high}, true).experiments, ElementsAre("first-2"));
    EXPECT_EQ(plan_in(low), low_);
    EXPECT_THAT(merge_stores(low, {high}, true).experiments, IsEmpty());
}

TEST_F(Merge, KeepsTheFirstOfTwoImagesAndSaysSo) {
    const fs::path low = make("low", {low_});
    const fs::path again = make("again", {low_});
    {
        const std::string id = task_id(low_.cells[2].task);
        Image image = read_exr(again / "runs" / id / "image.exr");
        image.rgb[0] += 1;
        write_exr(again / "runs" / id / "image.exr", image);
        Record record = made_up_record(low_.cells[2].task);
        record.image_sha256 = sha256_hex(read_file(again / "runs" / id / "image.exr"));
        write_file_durably(again / "runs" / id / "record.json", record_to_json(record).dump());
        const Image kept = Store(low, Store::Access::ReadOnly).run_image(id);
        EXPECT_THAT(merge_stores(low, {again}, false).other_images, ElementsAre(id));
        EXPECT_EQ(Store(low, Store::Access::ReadOnly).run_image(id), kept);
    }
}

TEST_F(Merge, CarriesTheSnapshotsOfARun) {
    const auto with_snapshots = [](Plan plan) {
        for (Cell& cell : plan.cells) {
            if (cell.role == Role::Test) cell.task.snapshots = SnapshotLadder{};
        }
        return plan;
    };
    const Plan plan = with_snapshots(plan_);
    const fs::path whole = make("whole", {plan});
    const fs::path low = make("low", {with_snapshots(low_)});
    merge_stores(low, {make("high", {with_snapshots(high_)})}, false);
    const Store merged(low, Store::Access::ReadOnly);
    const Store expected(whole, Store::Access::ReadOnly);
    int n_snapshots = 0;
    for (const Cell& cell : plan.cells) {
        const std::string id = task_id(cell.task);
        const Record record = expected.run(id).value();
        for (const SnapshotRecord& snapshot : record.snapshots) {
            const std::int64_t samples = snapshot.statistics.samples;
            EXPECT_EQ(merged.snapshot_image(id, samples), expected.snapshot_image(id, samples));
            ++n_snapshots;
        }
        EXPECT_EQ(merged.run(id)->snapshots, record.snapshots);
    }
    EXPECT_EQ(n_snapshots, 8 * 4);
    const auto values_of = [&plan](const Store& store) {
        std::map<std::pair<std::string, std::int64_t>, double> values;
        for (const SnapshotMeasurement& m : store.snapshot_measurements(plan, "mse")) {
            values[{m.run, m.samples}] = m.value;
        }
        return values;
    };
    EXPECT_EQ(values_of(merged), values_of(expected));
    EXPECT_THAT(values_of(merged), SizeIs(8 * 4));
}

TEST_F(Merge, OfOneWithoutItsSnapshotCopiesNothingOfThatRun) {
    Plan plan = low_;
    for (Cell& cell : plan.cells) {
        if (cell.role == Role::Test) cell.task.snapshots = SnapshotLadder{};
    }
    const fs::path from = make("from", {plan});
    const std::string id = task_id(plan.cells.back().task);
    fs::remove(from / "runs" / id / snapshot_file(4));
    EXPECT_THAT(message_of(Errc::DataLoss, [&] { merge_stores(path("to"), {from}, false); }),
                HasSubstr(snapshot_file(4)));
    EXPECT_FALSE(Store(path("to"), Store::Access::ReadOnly).has_run(id));
}

TEST_F(Merge, UnitesSeedsThatFollowARule) {
    const auto with_rule = [](Plan plan, int max) {
        plan.seed_rule = {.min = 2, .max = max, .ratio_halfwidth = 0.1};
        plan.configuration = nlohmann::json{{"seeds", seed_rule_to_json(*plan.seed_rule)}}.dump();
        return plan;
    };
    const fs::path low = make("low", {with_rule(low_, 4)});
    merge_stores(path("same"), {low, make("high", {with_rule(plan_, 4)})}, false);
    EXPECT_EQ(plan_in(path("same")), with_rule(plan_, 4));
    // What a rule led to is not said where there were two, or one of the parts had none.
    merge_stores(path("two"), {low, make("other", {with_rule(plan_, 8)})}, false);
    EXPECT_EQ(plan_in(path("two")).seed_rule, std::nullopt);
    EXPECT_EQ(plan_in(path("two")).cells, plan_.cells);
    Plan listed = high_;
    listed.configuration = R"({"seeds": [4, 3]})";
    merge_stores(path("mixed"), {low, make("listed", {listed})}, false);
    EXPECT_EQ(plan_in(path("mixed")).seed_rule, std::nullopt);
    EXPECT_EQ(plan_in(path("mixed")).cells, plan_.cells);
}

TEST_F(Merge, RefusesItselfAndWhatIsNoStore) {
    const fs::path low = make("low", {low_});
    EXPECT_THAT(message_of(Errc::InvalidArgument, [&] { merge_stores(low, {low}, false); }),
                HasSubstr("the store to merge into"));
    message_of(Errc::NotFound, [&] { merge_stores(path("new"), {path("none")}, false); });
    EXPECT_FALSE(fs::exists(path("new")));
}

TEST(Unite, SaysWhatDiffersInWords) {
    const Plan plan = made_up_plan("first", 2);
    EXPECT_EQ(what_differs(plan, plan), std::nullopt);
    Plan other = plan;
    other.baseline = "clever";
    EXPECT_EQ(what_differs(plan, other), "baseline 'plain', not 'clever'");
    other = plan;
    other.cells[0].task.seed = 7;
    EXPECT_EQ(what_differs(plan, other), "Box, reference_a: seed 1001, not 7");
    other = plan;
    other.scenes[0].exposure = 1;
    EXPECT_THAT(what_differs(plan, other).value(), HasSubstr("exposure of Box"));
}

TEST(TaskDifferences, NameEveryFieldOfTheIdentityAndNoOther) {
    const Task task = made_up_task("plain", 1, SampleBudget{16});
    Task other = task;
    other.scene = "Elsewhere";
    other.scene_file = "elsewhere.json";
    EXPECT_THAT(task_differences(task, other), IsEmpty());
    EXPECT_EQ(task_id(task), task_id(other));
    other = made_up_task("clever", 2, SampleBudget{8});
    other.parameters = {{"max_depth", 3.0}, {"mis", std::string("power2")}};
    other.scene_hash = "x";
    other.width = 5;
    other.method_version = 4;
    EXPECT_EQ(
        to_string(task_differences(task, other)),
        "scene content of scenes/Box.json (" + task.scene_hash.substr(0, 12) +
            "), not of scenes/Box.json (x); image size 8x4, not 5x4; method plain, not clever; "
            "method version 1, not 4; parameter max_depth 3, not 3.0; "
            "parameter mis none, not power2; budget 16 spp, not 8 spp; seed 1, not 2");
}

}  // namespace
}  // namespace misbench
