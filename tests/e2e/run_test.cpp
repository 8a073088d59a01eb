// What `misbench run` does when things go wrong: nothing is lost, nobody is left behind, and one
// line says what happened.
#include <gmock/gmock.h>
#include <sys/mount.h>

#include <algorithm>

#include "renderer/base/files.h"
#include "results/store.h"
#include "tests/support/process.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::StartsWith;

// About a dozen tasks of a quarter of a second.
constexpr const char* kExperiment = R"(name: slow
scenes: [CornellBox]
image: {width: 32, height: 24}
methods:
  nee: {method: path, max_depth: 3, bsdf: false}
  mis: {method: path, max_depth: 3}
seeds: 5
budgets: [{seconds: 0.25, clock: wall}]
reference: {method: mis, samples: 16}
)";
constexpr int kTasks = 12;

class RunTest : public testing::Test {
 protected:
    void SetUp() override {
        std::string name = (fs::temp_directory_path() / "misbench_run_XXXXXX").string();
        ASSERT_NE(::mkdtemp(name.data()), nullptr);
        folder_ = name;
        std::ofstream(file("slow.yaml")) << kExperiment;
    }
    void TearDown() override { fs::remove_all(folder_); }

    std::string file(const std::string& name) const { return (folder_ / name).string(); }

    std::vector<std::string> command(const std::string& store,
                                     const std::vector<std::string>& more = {}) const {
        std::vector<std::string> all{MISBENCH_PROGRAM, "run", file("slow.yaml"), "--store", store,
                                     "--workers",      "2",   "--progress",      "never"};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }

    Outcome run(const std::string& store, const std::vector<std::string>& more = {}) const {
        return Process(command(store, more), folder_).wait();
    }

    // Runs that are stored whole.
    static std::vector<fs::path> records(const std::string& store) {
        std::vector<fs::path> found;
        std::error_code ignored;
        for (const auto& run : fs::directory_iterator(store + "/runs", ignored)) {
            if (fs::exists(run.path() / "record.json")) found.push_back(run.path() / "record.json");
        }
        return found;
    }

    static bool has_runs(const std::string& store, std::size_t count) {
        return wait_until([&] { return records(store).size() >= count; });
    }

    static pid_t child_named(pid_t parent, const std::string& program) {
        for (const pid_t child : children_of(parent)) {
            if (command_of(child).find(program) != std::string::npos) return child;
        }
        return -1;
    }

    // The coordinator and both workers, once they are all there.
    static std::vector<pid_t> all_children(pid_t parent) {
        EXPECT_TRUE(wait_until([&] { return children_of(parent).size() == 3; }));
        return children_of(parent);
    }

    static void expect_all_dead(const std::vector<pid_t>& pids, seconds limit = seconds(10)) {
        for (const pid_t pid : pids) {
            EXPECT_TRUE(wait_until([pid] { return is_dead(pid); }, limit))
                << pid << ": " << command_of(pid);
        }
    }

    void expect_complete(const std::string& store) const {
        EXPECT_EQ(records(store).size(), static_cast<std::size_t>(kTasks));
        const Outcome status = Process({MISBENCH_PROGRAM, "status", store}, folder_).wait();
        EXPECT_THAT(status.out, ContainsRegex("slow +12 +12 +0 +0 +0 +0"));
    }

    fs::path folder_;
};

void expect_one_error(const Outcome& outcome, int exit_code, const std::string& message) {
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(StartsWith("misbench: error: "), HasSubstr(message)));
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
}

TEST_F(RunTest, AReportThatIsWatchedShowsErrorsWhileTheExperimentRuns) {
    const std::string store = file("store");
    Process running(command(store), folder_);
    ASSERT_TRUE(has_runs(store, 1));
    Process watching(
        {MISBENCH_PROGRAM, "report", store, "-o", file("r.html"), "--watch", "--interval", "0.1"},
        folder_);
    bool has_errors = false;
    const bool is_finished = wait_until([&] {
        const std::string html = slurp(file("r.html"));
        const bool is_running = html.find(R"("running":{"tasks":12,"done":)") != std::string::npos;
        has_errors |= is_running && html.find(R"("mean":{"value":)") != std::string::npos;
        return html.find(R"("running":null)") != std::string::npos;
    });
    EXPECT_TRUE(is_finished);
    EXPECT_TRUE(has_errors);
    EXPECT_EQ(watching.wait().exit_code, 0);
    EXPECT_EQ(running.wait().exit_code, 0);
    expect_complete(store);
}

TEST_F(RunTest, CtrlCKeepsWhatIsDoneAndASecondCallDoesTheRest) {
    const std::string store = file("store");
    Process first(command(store), folder_);
    ASSERT_TRUE(has_runs(store, 3));
    const std::vector<pid_t> children = all_children(first.pid());
    for (const pid_t child : children) EXPECT_NE(::getpgid(child), ::getpgid(first.pid()));
    first.send_to_group(SIGINT);
    const Outcome interrupted = first.wait();
    EXPECT_EQ(interrupted.exit_code, 130) << interrupted.err;
    EXPECT_THAT(interrupted.err, ContainsRegex("interrupted: [0-9]+ of 12 tasks are done and kept; "
                                               "resume with: .*misbench run .*slow.yaml"));
    EXPECT_EQ(interrupted.out, "");
    expect_all_dead(children);

    std::map<fs::path, std::string> kept;
    for (const fs::path& record : records(store)) kept[record] = slurp(record);
    EXPECT_GE(kept.size(), 3U);
    EXPECT_LT(kept.size(), static_cast<std::size_t>(kTasks));
    const Outcome resumed = run(store);
    EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
    EXPECT_THAT(resumed.out, HasSubstr("5 seeds"));
    for (const auto& [record, bytes] : kept) EXPECT_EQ(slurp(record), bytes) << record;
    expect_complete(store);
}

TEST_F(RunTest, SigtermEndsLikeCtrlC) {
    Process process(command(file("store")), folder_);
    ASSERT_TRUE(has_runs(file("store"), 1));
    const std::vector<pid_t> children = all_children(process.pid());
    ::kill(process.pid(), SIGTERM);
    EXPECT_EQ(process.wait().exit_code, 130);
    expect_all_dead(children);
}

TEST_F(RunTest, SigkillLeavesNoChildAliveAndLosesNothing) {
    const std::string store = file("store");
    // Tasks so long that nobody would notice the end of the run by himself.
    const std::vector<std::string> few{"--set", "seeds=1", "--set",
                                       "budgets=[{seconds: 5, clock: wall}]"};
    {
        Process process(command(store, few), folder_);
        ASSERT_TRUE(has_runs(store, 2));  // both halves of the reference
        const std::vector<pid_t> children = all_children(process.pid());
        std::this_thread::sleep_for(seconds(1));
        ::kill(process.pid(), SIGKILL);
        EXPECT_EQ(process.wait().exit_code, 128 + SIGKILL);
        expect_all_dead(children, seconds(2));
    }
    EXPECT_EQ(records(store).size(), 2U);
    EXPECT_EQ(run(store, few).exit_code, 0);
    EXPECT_EQ(records(store).size(), 4U);
}

TEST_F(RunTest, AWorkerAndACoordinatorThatDieAreStartedAgain) {
    const std::string store = file("store");
    Process process(command(store), folder_);
    ASSERT_TRUE(has_runs(store, 2));
    ::kill(child_named(process.pid(), "misbench-worker"), SIGKILL);
    ASSERT_TRUE(has_runs(store, 4));
    const pid_t coordinator = child_named(process.pid(), "misbench-coordinator");
    ::kill(coordinator, SIGKILL);
    const Outcome outcome = process.wait();
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("died with exit code 137, started again"),
                                   HasSubstr("coordinator died")));
    expect_complete(store);
}

TEST_F(RunTest, ACoordinatorThatKeepsDyingIsGivenUp) {
    Process process(command(file("store"), {"--set", "seeds=1000"}), folder_);
    ASSERT_TRUE(has_runs(file("store"), 1));
    const std::vector<pid_t> children = all_children(process.pid());
    for (pid_t before = -1; !is_dead(process.pid());) {
        const pid_t coordinator = child_named(process.pid(), "misbench-coordinator");
        if (coordinator != before && coordinator > 0) ::kill(before = coordinator, SIGKILL);
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    const Outcome outcome = process.wait();
    EXPECT_EQ(outcome.exit_code, 4);
    EXPECT_THAT(outcome.err,
                HasSubstr("misbench: error: keep the coordinator alive: coordinator died 6 times"));
    expect_all_dead(children);
}

TEST_F(RunTest, ASecondRunOnTheSameStoreIsRefusedAndTheFirstGoesOn) {
    const std::string store = file("store");
    Process first(command(store), folder_);
    ASSERT_TRUE(has_runs(store, 1));
    expect_one_error(run(store), 3, "in use");
    const Outcome outcome = first.wait();
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    expect_complete(store);
}

TEST_F(RunTest, TasksThatFailAreNamedAndTheOthersDone) {
    fs::create_directories(file("scenes"));
    fs::copy(MISBENCH_SCENES "/VeachMIS", file("scenes/VeachMIS"), fs::copy_options::recursive);
    fs::copy(MISBENCH_SCENES "/CornellBox", file("scenes/CornellBox"), fs::copy_options::recursive);
    const std::string mesh = file("scenes/VeachMIS/meshes/mesh3.ply");
    fs::resize_file(mesh, fs::file_size(mesh) / 2);
    const Outcome outcome = run(file("store"), {"--set", "scenes=[CornellBox, VeachMIS]", "--set",
                                                "seeds=1", "--scenes", file("scenes")});
    EXPECT_EQ(outcome.exit_code, 1);
    // Two halves of the reference and two methods, one line each.
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 4) << outcome.err;
    EXPECT_THAT(outcome.err,
                AllOf(HasSubstr("misbench: error: task failed: VeachMIS, nee, 0.25 s wall"),
                      HasSubstr("seed 1: "), HasSubstr("mesh3.ply")));
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("CornellBox"), HasSubstr("0 of 1 seeds: 1 failed")));
    EXPECT_EQ(records(file("store")).size(), 4U);

    // Mended, only they are done again.
    fs::copy(MISBENCH_SCENES "/VeachMIS/meshes/mesh3.ply", mesh,
             fs::copy_options::overwrite_existing);
    const Outcome again = run(file("store"), {"--set", "scenes=[CornellBox, VeachMIS]", "--set",
                                              "seeds=1", "--scenes", file("scenes")});
    EXPECT_EQ(again.exit_code, 0) << again.err;
}

TEST_F(RunTest, AFullDiskIsSaidAndLosesNothing) {
    const std::string disk = file("disk");
    fs::create_directories(disk);
    if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=400k") != 0) {
        GTEST_SKIP() << "may not mount a small disk here";
    }
    const std::string store = disk + "/store";
    const std::vector<std::string> larger{"--set", "image.width=128", "--set", "image.height=96"};
    const Outcome full = run(store, larger);
    const std::size_t n_kept = records(store).size();
    EXPECT_EQ(full.exit_code, 3) << full.err;
    EXPECT_THAT(full.err, ContainsRegex("No space left on device|disk is full"));
    EXPECT_EQ(std::ranges::count(full.err, '\n'), 1) << full.err;
    EXPECT_LT(n_kept, static_cast<std::size_t>(kTasks));

    EXPECT_EQ(::mount("tmpfs", disk.c_str(), "tmpfs", MS_REMOUNT, "size=64m"), 0);
    const Outcome resumed = run(store, larger);
    EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
    EXPECT_EQ(records(store).size(), static_cast<std::size_t>(kTasks));
    EXPECT_EQ(::umount(disk.c_str()), 0);
}

TEST_F(RunTest, ADirectoryThatIsNoStoreIsLeftAlone) {
    fs::create_directories(file("photos"));
    std::ofstream(file("photos/holiday.jpg")) << "not a run";
    expect_one_error(run(file("photos")), 3, "photos");
    EXPECT_EQ(std::distance(fs::directory_iterator(file("photos")), fs::directory_iterator()), 1);
}

}  // namespace
}  // namespace misbench
