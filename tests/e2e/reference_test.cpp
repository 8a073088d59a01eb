// misbench reference, as a user would: which reference is too noisy, a better one, and that the
// old one is there until the better one is.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "results/reference_noise.h"
#include "results/store.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// A reference of few samples beside tests of many.
constexpr const char* kExperiment = R"(name: noisy
scenes: [CornellBox]
image: {width: 32, height: 24}
methods:
  nee: {method: path, max_depth: 3, bsdf: false}
  mis: {method: path, max_depth: 3}
seeds: 5
budgets: [{samples: 64}]
reference: {method: mis, samples: 32}
)";
constexpr int kFactor = 32;

class ReferenceTest : public testing::Test {
 protected:
    ReferenceTest() {
        folder_.write("noisy.yaml", kExperiment);
        run("store");
    }

    std::string file(const std::string& name) const { return (folder_.path() / name).string(); }

    Outcome misbench(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), MISBENCH_PROGRAM);
        return Process(arguments, folder_.path()).wait();
    }
    void run(const std::string& store, const std::vector<std::string>& more = {}) const {
        std::vector<std::string> all{"run", file("noisy.yaml"), "--store", file(store)};
        all.insert(all.end(), more.begin(), more.end());
        const Outcome outcome = misbench(all);
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    }
    std::vector<std::string> improve(int factor) const {
        return {MISBENCH_PROGRAM, "reference", file("store"), "--improve", std::to_string(factor)};
    }
    std::string table(const std::string& store, const std::string& format = "csv") const {
        return misbench({"table", file(store), "--format", format}).out;
    }
    std::string status() const { return misbench({"status", file("store")}).out; }

    static Plan plan_of(const Store& store) { return store.experiment("noisy"); }
    // Mean share of the reference's noise over all runs.
    double share() const {
        const Store store(file("store"), Store::Access::ReadOnly);
        double sum = 0;
        int n = 0;
        for (const CellSeeds& cell : store.cell_seeds("noisy", std::vector<std::string>{})) {
            for (const double share : cell.reference_shares) sum += share;
            n += static_cast<int>(cell.reference_shares.size());
        }
        return sum / n;
    }
    // Mean error over the seeds of a method.
    double error(const std::string& store, const std::string& method) const {
        const Store opened(file(store), Store::Access::ReadOnly);
        for (const CellSeeds& cell :
             opened.cell_seeds("noisy", std::vector<std::string>{"relmse.eps0.01"})) {
            if (cell.method != method) continue;
            double sum = 0;
            for (const double value : cell.values.at("relmse.eps0.01")) sum += value;
            return sum / static_cast<double>(cell.seeds.size());
        }
        throw std::runtime_error(method);
    }

    TemporaryFolder folder_;
};

TEST_F(ReferenceTest, ABetterOneIsThatOfAFileWithMoreSamples) {
    EXPECT_THAT(misbench({"reference", file("store")}).out,
                AllOf(HasSubstr("2 × 32 spp"), HasSubstr("too noisy")));
    const double share_before = share();
    const std::string before = table("store");
    const Outcome improved = Process(improve(kFactor), folder_.path()).wait();
    ASSERT_EQ(improved.exit_code, 0) << improved.err;
    EXPECT_THAT(improved.err, HasSubstr("goes back to the reference of its file"));

    // Both methods have the variance V/64 of the reference's, which has V/(2·32·32).
    EXPECT_GT(share_before, kNoisyReference);
    EXPECT_NEAR(share(), 1.0 / (1 + kFactor), 0.3 / (1 + kFactor));
    EXPECT_THAT(misbench({"reference", file("store")}).out, HasSubstr("2 × 1024 spp"));
    EXPECT_NE(table("store"), before);
    EXPECT_THAT(status(), Not(HasSubstr(".references")));

    // The runs, the errors and the table of an experiment that asked for it from the start.
    run("other", {"--set", "reference.samples=1024"});
    {
        const Store store(file("store"), Store::Access::ReadOnly);
        const Store other(file("other"), Store::Access::ReadOnly);
        for (const Cell& cell : plan_of(other).cells) {
            const std::string id = task_id(cell.task);
            ASSERT_TRUE(store.has_run(id));
            EXPECT_EQ(store.run(id)->image_sha256, other.run(id)->image_sha256);
        }
        EXPECT_EQ(store.measurements(plan_of(store)).size(),
                  other.measurements(plan_of(other)).size());
    }
    for (const std::string method : {"nee", "mis"}) {
        EXPECT_EQ(error("store", method), error("other", method));
    }

    // `misbench run` goes back to the file; the command again renders nothing.
    run("store");
    EXPECT_EQ(table("store"), before);
    const auto log = fs::last_write_time(file("store/logs/coordinator.log"));
    EXPECT_EQ(Process(improve(kFactor), folder_.path()).wait().out, improved.out);
    EXPECT_EQ(fs::last_write_time(file("store/logs/coordinator.log")), log);
    // And now nothing is too noisy.
    EXPECT_THAT(Process(improve(2), folder_.path()).wait().err, HasSubstr("no reference is too"));
}

TEST_F(ReferenceTest, AnInterruptedImprovementLeavesTheOldOneWhole) {
    const std::string before = table("store", "text");
    const std::string status_before = status();
    for (const int signal : {SIGKILL, SIGINT}) {
        Process process(improve(1000), folder_.path());
        ASSERT_TRUE(wait_until([&] { return children_of(process.pid()).size() == 2; }));
        const std::vector<pid_t> children = children_of(process.pid());
        std::this_thread::sleep_for(std::chrono::milliseconds(500));
        EXPECT_EQ(table("store", "text"), before) << "while it is rendered";
        ::kill(process.pid(), signal);
        const Outcome outcome = process.wait();
        for (const pid_t child : children) {
            EXPECT_TRUE(wait_until([child] { return is_dead(child); }));
        }
        EXPECT_EQ(outcome.exit_code, signal == SIGINT ? 130 : 128 + SIGKILL) << outcome.err;
        EXPECT_EQ(table("store", "text"), before);
        if (signal == SIGKILL) continue;
        EXPECT_THAT(outcome.err, AllOf(HasSubstr("of 2 tasks are done and kept"),
                                       HasSubstr("misbench reference " + file("store") +
                                                 " --experiment noisy --improve 1000")));
        EXPECT_EQ(status(), status_before);
    }
    ASSERT_EQ(Process(improve(kFactor), folder_.path()).wait().exit_code, 0);
    EXPECT_THAT(misbench({"reference", file("store")}).out, HasSubstr("2 × 1024 spp"));
    EXPECT_THAT(status(), Not(HasSubstr(".references")));
}

TEST_F(ReferenceTest, RefusesAFactorThatImprovesNothing) {
    const Outcome outcome = Process(improve(1), folder_.path()).wait();
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("--improve"));
}

}  // namespace
}  // namespace misbench
