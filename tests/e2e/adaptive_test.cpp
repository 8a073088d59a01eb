// Experiments whose seeds follow a rule, as a user runs them: to the end, killed on the way, again,
// with images of others beside, and in two parts.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "experiments/plan/imported.h"
#include "results/store.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;

// Of one seed, "easy" is about as wrong as the baseline; what "hard" finds by chance is rare.
constexpr const char* kExperiment = R"(name: adaptive
scenes: [CornellBox]
image: {width: 16, height: 12}
methods:
  base: {method: path, max_depth: 3, bsdf: false}
  easy: {method: path, max_depth: 3}
  hard: {method: path, max_depth: 3, nee: false}
baseline: base
seeds: {min: 4, max: 12, until: {ratio_halfwidth: 0.15}}
budgets: [{samples: 32}]
reference: {method: base, samples: 256}
)";
constexpr std::size_t kFirstRound = 2 + 3 * 4;

class AdaptiveTest : public testing::Test {
 protected:
    AdaptiveTest() { folder_.write("adaptive.yaml", kExperiment); }

    std::string file(const std::string& name) const { return (folder_.path() / name).string(); }

    Outcome misbench(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), MISBENCH_PROGRAM);
        return Process(arguments, folder_.path()).wait();
    }
    static std::vector<std::string> command(const std::string& yaml, const std::string& store) {
        return {MISBENCH_PROGRAM, "run", yaml, "--store", store, "--progress", "never"};
    }
    Outcome run(const std::string& store, const std::vector<std::string>& more = {}) const {
        std::vector<std::string> all = command(file("adaptive.yaml"), file(store));
        all.insert(all.end(), more.begin(), more.end());
        return Process(all, folder_.path()).wait();
    }

    // By the run's id, with the bytes of the record.
    std::map<std::string, std::string> records(const std::string& store) const {
        std::map<std::string, std::string> found;
        std::error_code ignored;
        for (const auto& run : fs::directory_iterator(file(store) + "/runs", ignored)) {
            const std::string record = slurp(run.path() / "record.json");
            if (!record.empty()) found[run.path().filename()] = record;
        }
        return found;
    }
    std::vector<Cell> cells(const std::string& store) const {
        return Store(file(store), Store::Access::ReadOnly).experiment("adaptive").cells;
    }
    std::map<std::string, int> seeds(const std::string& store) const {
        std::map<std::string, int> counts;
        for (const Cell& cell : cells(store)) {
            if (cell.role == Role::Test) ++counts[cell.method];
        }
        return counts;
    }
    std::set<std::string> planned(const std::string& store) const {
        std::set<std::string> ids;
        for (const Cell& cell : cells(store)) ids.insert(task_id(cell.task));
        return ids;
    }
    std::set<std::string> ids(const std::string& store) const {
        std::set<std::string> found;
        for (const auto& [id, record] : records(store)) found.insert(id);
        return found;
    }

    TemporaryFolder folder_;
};

TEST_F(AdaptiveTest, EasyCellsGetFewerSeedsAndAFinishedExperimentRendersNothing) {
    const Outcome outcome = run("store");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto n = seeds("store");
    EXPECT_LT(n.at("easy"), n.at("hard"));
    EXPECT_EQ(n.at("base"), n.at("hard")) << "pairs";
    EXPECT_LE(n.at("hard"), 12);
    EXPECT_THAT(outcome.out,
                AllOf(HasSubstr("mean over " + std::to_string(n.at("easy")) + " to " +
                                std::to_string(n.at("hard")) + " seeds"),
                      ContainsRegex("seeds: 4 to 12, until the ratio is known within ± 15 %: met "
                                    "by 1 of 2 ratios; 1 stopped at 12 seeds")));
    EXPECT_EQ(ids("store"), planned("store"));

    const auto before = records("store");
    const std::vector<Cell> cells_before = cells("store");
    const fs::path log = file("store/logs/coordinator.log");
    const auto log_before = fs::last_write_time(log);
    const Outcome again = run("store");
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(again.out, outcome.out);
    EXPECT_EQ(records("store"), before);
    EXPECT_EQ(cells("store"), cells_before);
    EXPECT_EQ(fs::last_write_time(log), log_before) << "nobody was started";

    const auto table =
        nlohmann::json::parse(misbench({"table", file("store"), "--format", "json"}).out);
    EXPECT_THAT(table.dump(), HasSubstr("easy"));
    // Of another metric or baseline the outcome is not said.
    const Outcome other = misbench({"table", file("store"), "--ratio-to", "easy"});
    EXPECT_THAT(other.out, HasSubstr("until the ratio to 'base' in relmse.eps0.01 is known within "
                                     "± 15 %\n"));
}

TEST_F(AdaptiveTest, KilledOnTheWayItLosesNoRunAndGoesThroughTheSameRounds) {
    {
        Process process(command(file("adaptive.yaml"), file("store")), folder_.path());
        ASSERT_TRUE(wait_until([&] { return records("store").size() > kFirstRound; }));
        ::kill(process.pid(), SIGKILL);
        EXPECT_EQ(process.wait().exit_code, 128 + SIGKILL);
    }
    // The coordinator finishes its commit before it goes.
    ASSERT_TRUE(wait_until([&] {
        try {
            Store(file("store"), Store::Access::ReadWrite);
            return true;
        } catch (const std::exception&) {
            return false;
        }
    }));
    const auto kept = records("store");
    EXPECT_GT(kept.size(), kFirstRound);
    const Outcome resumed = run("store");
    ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
    const auto all = records("store");
    EXPECT_GT(all.size(), kept.size()) << "it was killed too late";
    for (const auto& [id, bytes] : kept) EXPECT_EQ(all.at(id), bytes);
    EXPECT_EQ(ids("store"), planned("store")) << "no run is outside of the final plan";

    // Without an interruption the same records lead to the same plan.
    const std::vector<Cell> cells_before = cells("store");
    EXPECT_EQ(run("store").out, resumed.out);
    EXPECT_EQ(cells("store"), cells_before);
    EXPECT_EQ(records("store"), all);
}

TEST_F(AdaptiveTest, PlanSaysWhatItCostsAtLeastAndAtMost) {
    const Outcome text = misbench({"plan", file("adaptive.yaml")});
    EXPECT_THAT(text.out,
                AllOf(HasSubstr("adaptive: 4 to 12 seeds, until the ratio is known within ± 15 %"),
                      HasSubstr("  at least: 14 tasks, 0 in the store, 14 to do; about "),
                      HasSubstr("  at most:  38 tasks, 0 in the store, 38 to do; about "),
                      HasSubstr("\nif needed  ")));
    const std::vector<std::string> timed{
        "plan",  file("adaptive.yaml"), "--json", "--set", "budgets=[{seconds: 3}]",
        "--set", "reference.samples=1"};
    const auto json = nlohmann::json::parse(misbench(timed).out);
    EXPECT_EQ(json.at("least").at("tasks"), 14);
    EXPECT_NEAR(json.at("least").at("estimated_seconds").get<double>(), 3 * 4 * 3, 0.1);
    EXPECT_EQ(json.at("tasks"), 38);
    EXPECT_NEAR(json.at("estimated_seconds").get<double>(), 3 * 12 * 3, 0.1);
    EXPECT_EQ(json.at("configuration").at("seeds").at("max"), 12);
}

TEST_F(AdaptiveTest, ImagesOfOthersStandBesideAndGetNoSeeds) {
    const std::vector<std::string> small{"--set", "seeds.max=5"};
    ASSERT_EQ(run("store", small).exit_code, 0);
    for (const std::string seed : {"1", "2", "3"}) {
        const std::string image = file("mine" + seed + ".exr");
        ASSERT_EQ(misbench({"render", "CornellBox", "--method", "light", "--spp", "2", "--size",
                            "16x12", "--seed", seed, "-o", image})
                      .exit_code,
                  0);
        const Outcome imported =
            misbench({"import", file("store"), "--experiment", "adaptive", "--scene", "CornellBox",
                      "--method", "mine", "--samples", "2", "--seed", seed, image});
        ASSERT_EQ(imported.exit_code, 0) << imported.err;
    }
    const Outcome again = run("store", small);
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_THAT(again.out, AllOf(HasSubstr("mine"), HasSubstr("of 2 ratios")));
    EXPECT_EQ(seeds("store").at("mine"), 3);
}

TEST_F(AdaptiveTest, TwoPartsMakeOneStore) {
    ASSERT_EQ(run("a", {"--set", "seeds.max=4"}).exit_code, 0);
    ASSERT_EQ(run("b", {"--set", "seeds.max=4", "--set", "scenes=[VeachMIS]"}).exit_code, 0);
    const Outcome merged = misbench({"merge", file("both"), file("a"), file("b")});
    EXPECT_EQ(merged.exit_code, 0) << merged.err;
    const Outcome table = misbench({"table", file("both")});
    EXPECT_THAT(table.out, AllOf(HasSubstr("CornellBox"), HasSubstr("VeachMIS"),
                                 HasSubstr("seeds: 4 to 4, until"), HasSubstr("of 4 ratios")));
}

}  // namespace
}  // namespace misbench
