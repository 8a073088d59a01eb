#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "renderer/base/error.h"
#include "results/metrics/metrics.h"
#include "results/reference_noise.h"
#include "results/schema.h"
#include "results/store.h"
#include "tests/support/store_fixture.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

using StoreDatabaseTest = StoreTest;

TEST_F(StoreDatabaseTest, ADroppedExperimentLeavesItsRunsAndTheTasksOfOthers) {
    Store store = open();
    commit_all(store, plan_);
    store.put_experiment(plan_);
    Plan halves = plan_;
    halves.experiment = plan_.experiment + kReferencesAlone;
    std::erase_if(halves.cells, [](const Cell& cell) { return cell.role == Role::Test; });
    halves.cells[0].task.budget = halves.cells[0].budget = SampleBudget{4096};
    store.put_experiment(halves);
    EXPECT_EQ(store.experiments().back(), halves.experiment) << "though it was put last";
    EXPECT_EQ(store.experiment("").experiment, plan_.experiment);
    const std::string id = task_id(halves.cells[0].task);
    EXPECT_TRUE(store.task(id));
    store.drop_experiment(halves.experiment);
    store.drop_experiment(halves.experiment);
    EXPECT_EQ(store.experiments(), std::vector{plan_.experiment});
    EXPECT_FALSE(store.task(id));
    for (const Cell& cell : plan_.cells) {
        EXPECT_TRUE(store.task(task_id(cell.task)) && store.has_run(task_id(cell.task)));
    }
    EXPECT_FALSE(fs::exists(folder() / "experiments" / (halves.experiment + ".json")));
}

// --- snapshots and the reference's noise -------------------------------------------------------

TEST_F(StoreDatabaseTest, MeasuresSnapshotsBesideTheImage) {
    Plan plan = plan_;
    for (Cell& cell : plan.cells) {
        if (cell.role == Role::Test) cell.task.snapshots = SnapshotLadder{};
    }
    Store store = open();
    store.put_experiment(plan);
    commit_all(store, plan);
    EXPECT_EQ(store.measure(plan), 6 * 5 * 2)
        << "six runs, four snapshots and an image, two metrics";
    EXPECT_EQ(store.measure(plan), 0);
    EXPECT_EQ(store.measurements(plan).size(), 12U) << "the images' alone";
    EXPECT_THAT(store.snapshot_measurements(plan, "relmse"), testing::IsEmpty());
    const auto curve = store.snapshot_measurements(plan, "mse");
    ASSERT_EQ(curve.size(), 24U);
    const Image a = store.run_image(task_id(plan.cells[0].task));
    const Image b = store.run_image(task_id(plan.cells[1].task));
    for (std::size_t i = 0; i < curve.size(); ++i) {
        EXPECT_EQ(curve[i].samples, 1 << i % 4);
        EXPECT_EQ(curve[i].passes, 1 << i % 4);
        EXPECT_EQ(curve[i].cpu_seconds, 0.125 * double(1 << i % 4));
        const Image image = store.snapshot_image(curve[i].run, curve[i].samples);
        EXPECT_EQ(curve[i].value, measure(find_metric("mse"), image, {a, b}));
    }
}

TEST_F(StoreDatabaseTest, KnowsTheReferencesShareOfEachError) {
    Store store = open();
    store.put_experiment(plan_);
    commit_all(store, plan_);
    const auto cells = [&] { return store.cell_seeds(plan_.experiment, {}); };
    EXPECT_FALSE(mean_reference_share(cells()[0]));
    store.measure(plan_);
    // Variances by samples: 1/16, a quarter of it for "clever", and 1/1024/2 of the reference.
    const std::vector<double> of_plain = cells()[0].reference_shares;
    const std::vector<double> of_clever = cells()[1].reference_shares;
    // The halves have 96 values: within a factor of two.
    const auto within_two = testing::AllOf(testing::Gt(0.5), testing::Lt(2));
    ASSERT_EQ(of_plain.size(), 3U);
    EXPECT_THAT(of_plain[0] * 129, within_two);
    EXPECT_THAT(of_clever[0] * 33, within_two);
    EXPECT_DOUBLE_EQ(*mean_reference_share(cells()[0]),
                     (of_plain[0] + of_plain[1] + of_plain[2]) / 3);
}

TEST(ReferenceShare, IsOneWhereNothingElseIsLeftAndZeroWithoutNoise) {
    const Image a(2, 2);
    Image b(2, 2);
    EXPECT_EQ(reference_share(a, {a, a}), 0);
    b.rgb[0] = 2;
    EXPECT_EQ(reference_share(b, {a, a}), 0);
    EXPECT_DOUBLE_EQ(reference_share(a, {a, b}), 1) << "the image is one of the halves";
    Image mean(2, 2);
    mean.rgb[0] = 1;
    EXPECT_EQ(reference_share(mean, {a, b}), 1);
}

// --- measurements ------------------------------------------------------------------------------

TEST_F(StoreDatabaseTest, MeasuresOnceWhatIsThere) {
    Store store = open();
    store.put_experiment(plan_);
    commit_all(store, plan_);
    EXPECT_EQ(store.measure(plan_), 3 * 2 * 2);
    EXPECT_EQ(store.measure(plan_), 0);
    EXPECT_EQ(store.measurements(plan_).size(), 12U);
    Plan more = plan_;
    more.metrics.push_back("mean");
    EXPECT_EQ(store.measure(more), 6);
    EXPECT_EQ(store.measurements(plan_).size(), 12U);
}

TEST_F(StoreDatabaseTest, MeasuresInMemoryWhatAnotherProcessIsWriting) {
    Store writer = open();
    writer.put_experiment(plan_);
    for (std::size_t i = 0; i < 4; ++i) commit_made_up_run(writer, plan_.cells[i].task);
    Store reader = open(Store::Access::ReadOnly);
    EXPECT_EQ(reader.measure_in_memory(plan_), 2 * 2);
    EXPECT_THAT(writer.measurements(plan_), IsEmpty());
    EXPECT_THAT(reader.measurements(plan_), SizeIs(4));
    commit_all(writer, plan_);
    EXPECT_EQ(reader.measure_in_memory(plan_), 2 * 4);
    const auto values = [this](const Store& store) {
        std::vector<std::map<std::string, std::vector<double>>> all;
        for (const CellSeeds& cell : store.cell_seeds(plan_.experiment, plan_.metrics)) {
            all.push_back(cell.values);
        }
        return all;
    };
    const auto in_memory = values(reader);

    EXPECT_EQ(writer.measure(plan_), 2 * 6);
    EXPECT_EQ(values(writer), in_memory);
    EXPECT_EQ(values(reader), in_memory);
    EXPECT_EQ(reader.measure_in_memory(plan_), 0);
    Store late = open(Store::Access::ReadOnly);
    EXPECT_EQ(late.measure_in_memory(plan_), 0) << "what the file has is not measured again";
}

TEST_F(StoreDatabaseTest, ARolledUpExperimentIsMeasuredInMemoryToo) {
    Store writer = open();
    writer.put_experiment(plan_);
    commit_all(writer, plan_);
    Plan other = made_up_plan("other", 1);
    writer.put_experiment(other);
    writer.measure(other);  // rolls up both, and "first" has more seeds
    Store reader = open(Store::Access::ReadOnly);
    reader.measure_in_memory(plan_);
    for (const CellSeeds& cell : reader.cell_seeds(plan_.experiment, plan_.metrics)) {
        for (const double value : cell.values.at("mse")) EXPECT_TRUE(std::isfinite(value));
    }
}

TEST_F(StoreDatabaseTest, MeasuresNothingWithoutBothHalvesOfTheReference) {
    Store store = open();
    store.put_experiment(plan_);
    for (std::size_t i = 1; i < plan_.cells.size(); ++i) {
        commit_made_up_run(store, plan_.cells[i].task);
    }
    EXPECT_EQ(store.measure(plan_), 0);
    // The other half comes, but it has non-finite samples.
    commit_made_up_run(store, plan_.cells[0].task, [](Record& r) { r.valid = false; });
    EXPECT_EQ(store.measure(plan_), 0);
    Plan without = plan_;
    std::erase_if(without.cells, [](const Cell& cell) { return cell.role != Role::Test; });
    EXPECT_EQ(store.measure(without), 0);
}

TEST_F(StoreDatabaseTest, MeasuresNoInvalidRun) {
    Store store = open();
    store.put_experiment(plan_);
    for (const Cell& cell : plan_.cells) {
        const bool valid = cell.task != task_;
        commit_made_up_run(store, cell.task, [valid](Record& r) { r.valid = valid; });
    }
    EXPECT_EQ(store.measure(plan_), 5 * 2);
    for (const Measurement& m : store.measurements(plan_)) EXPECT_NE(m.run, task_id(task_));
}

TEST_F(StoreDatabaseTest, RefusesToStoreANumberThatIsNotFinite) {
    Store store = open();
    for (const Cell& cell : plan_.cells) {
        const fs::path staged = stage_made_up_run(store, cell.task);
        Image image = made_up_image(cell.task);
        if (cell.task == task_) image.rgb[7] = std::numeric_limits<float>::quiet_NaN();
        write_exr(staged / "image.exr", image);
        Record record = made_up_record(cell.task);
        record.image_sha256 = sha256_hex(read_file(staged / "image.exr"));
        write_file_durably(staged / "record.json", record_to_json(record).dump());
        store.commit_run(staged);
    }
    EXPECT_THAT(message_of(Errc::DataLoss, [&] { store.measure(plan_); }),
                testing::AllOf(HasSubstr(task_id(task_)), HasSubstr("not finite")));
    EXPECT_TRUE(store.measurements(plan_).empty());
}

// --- the database ------------------------------------------------------------------------------

class Rows {
 public:
    Rows(const fs::path& folder, const std::string& sql)
        : database_(open_database(folder / "results.sqlite", Database::Access::ReadOnly)),
          select_(database_->prepare(sql)) {}
    std::vector<std::string> column(int index) {
        std::vector<std::string> values;
        select_.bind();
        while (select_.step()) values.push_back(select_.text(index));
        return values;
    }

 private:
    std::unique_ptr<Database> database_;
    Statement select_;
};

TEST_F(StoreDatabaseTest, ViewShowsEveryTestedCellWithItsState) {
    {
        Store store = open();
        store.put_experiment(plan_);
        for (const Cell& cell : plan_.cells) {
            if (cell.method == "clever" && cell.seed == 3) continue;
            const bool valid = cell.method != "plain" || cell.seed != 2;
            commit_made_up_run(store, cell.task, [valid](Record& r) { r.valid = valid; });
        }
        store.measure(plan_);
    }
    EXPECT_THAT(Rows(folder(),
                     "SELECT method || seed || state FROM results WHERE "
                     "ifnull(metric, 'mse') = 'mse' ORDER BY method, seed")
                    .column(0),
                ElementsAre("clever1done", "clever2done", "clever3pending", "plain1done",
                            "plain2invalid", "plain3done"));
    EXPECT_THAT(Rows(folder(),
                     "SELECT DISTINCT experiment || scene || budget || passes FROM "
                     "results WHERE value IS NOT NULL")
                    .column(0),
                ElementsAre("firstBox16 spp16"));
}

TEST_F(StoreDatabaseTest, TableOfOneExperimentNeverScansAWholeTable) {
    open().put_experiment(plan_);
    const auto steps = Rows(folder(),
                            "EXPLAIN QUERY PLAN SELECT scene, method, avg(value) FROM "
                            "results WHERE experiment = 'first' GROUP BY scene, method")
                           .column(3);
    EXPECT_FALSE(steps.empty());
    for (const std::string& step : steps) EXPECT_THAT(step, testing::Not(HasSubstr("SCAN")));
}

TEST_F(StoreDatabaseTest, RefusesAnotherSchemaVersionAndSaysWhatHelps) {
    open();
    {
        Database database(folder() / "results.sqlite", Database::Access::ReadWrite);
        database.execute("PRAGMA user_version = 77");
    }
    for (const auto access : {Store::Access::ReadOnly, Store::Access::ReadWrite}) {
        EXPECT_THAT(message_of(Errc::FailedPrecondition, [&] { open(access); }),
                    HasSubstr("its schema is version 77, this program's is 3; `misbench reindex`"));
    }
}

TEST_F(StoreDatabaseTest, LeavesAnotherProgramsDatabaseAlone) {
    fs::create_directories(folder());
    {
        Database database(folder() / "results.sqlite", Database::Access::ReadWrite);
        database.execute("CREATE TABLE photographs (name TEXT)");
    }
    const std::string bytes = read_file(folder() / "results.sqlite");
    for (const auto access : {Store::Access::ReadOnly, Store::Access::ReadWrite}) {
        EXPECT_THAT(message_of(Errc::FailedPrecondition, [&] { open(access); }),
                    HasSubstr("not the database of a misbench store"));
    }
    EXPECT_EQ(read_file(folder() / "results.sqlite"), bytes);
}

TEST_F(StoreDatabaseTest, MakesNoStoreInAFolderOfOtherThings) {
    fs::create_directories(folder() / "photographs");
    EXPECT_THAT(message_of(Errc::FailedPrecondition, [&] { open(); }),
                HasSubstr("has other files and is no store"));
    EXPECT_FALSE(fs::exists(folder() / "runs"));
    fs::remove(folder() / "photographs");
    open();
}

TEST_F(StoreDatabaseTest, SaysThatADamagedDatabaseCanBeMadeAnew) {
    open();
    write_file_durably(folder() / "results.sqlite", std::string(8192, 'x'));
    for (const auto access : {Store::Access::ReadOnly, Store::Access::ReadWrite}) {
        EXPECT_THAT(message_of(Errc::DataLoss, [&] { open(access); }),
                    testing::AllOf(HasSubstr("results.sqlite"), HasSubstr("misbench reindex")));
    }
}

}  // namespace
}  // namespace misbench
