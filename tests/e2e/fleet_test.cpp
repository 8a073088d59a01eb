// Coordinator and workers as real processes, some of which are killed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>

#include "proto/client.h"
#include "renderer/base/error.h"
#include "renderer/methods/catalogue.h"
#include "renderer/scene/load.h"
#include "tests/support/made_up_store.h"
#include "tests/support/process.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr seconds kPatience{60};
// Long enough to be seen running, and to be killed meanwhile, also on a busy machine.
constexpr double kLongTaskSeconds = 1.5;
constexpr milliseconds kWellIntoIt{300};

// Nothing when it still runs after `limit`.
std::optional<int> exit_code_of(Process& process, seconds limit = seconds(20)) {
    if (!wait_until([&] { return is_dead(process.pid()); }, limit)) return std::nullopt;
    return process.wait().exit_code;
}

void send(const Process& process, int signal) { ::kill(process.pid(), signal); }

Task cornell_box(const std::string& method, std::int64_t seed, Budget budget) {
    static const std::string file = MISBENCH_SCENES "/CornellBox/CornellBox.json";
    static const std::string hash = scene_content_hash(file);
    const MethodInfo& info = find_method(method);
    return {.scene_hash = hash,
            .width = 32,
            .height = 32,
            .method = method,
            .method_version = info.version,
            .parameters = info.effective({}),
            .budget = budget,
            .seed = seed,
            .scene = "CornellBox",
            .scene_file = file};
}

Plan make_plan(const std::vector<Task>& tasks) {
    Plan plan{.experiment = "fleet",
              .description = "",
              .scenes = {{.name = "CornellBox", .exposure = 0}},
              .methods = {"path", "direct"},
              .budgets = {},
              .baseline = "path",
              .metrics = {"mse"},
              .cells = {},
              .configuration = "{}"};
    for (const Task& task : tasks) {
        plan.cells.push_back({.scene = task.scene,
                              .method = task.method,
                              .budget = task.budget,
                              .seed = task.seed,
                              .role = Role::Test,
                              .task = task});
    }
    return plan;
}

// A store with whoever works on it.
class Fleet {
    TemporaryFolder folder_;  // first, to go after the processes

 public:
    Fleet() { start_coordinator("127.0.0.1:0"); }

    void start_coordinator(const std::string& listen) {
        fs::remove(address_file());
        coordinator = std::make_unique<Process>(
            std::vector<std::string>{MISBENCH_COORDINATOR, "--store", store_path(), "--listen",
                                     listen, "--address-file", address_file(), "--lease-seconds",
                                     "2", "--exit-with-parent"},
            folder());
        wait_for("the coordinator's address", [&] { return fs::exists(address_file()); });
        address = read_file(address_file());
    }

    std::vector<std::string> worker_command(int threads) const {
        return {MISBENCH_WORKER,
                "--coordinator",
                address,
                "--threads",
                std::to_string(threads),
                "--scratch",
                folder_.path() / "scratch",
                "--exit-with-parent",
                "--give-up-seconds",
                "30"};
    }
    std::unique_ptr<Process> start_worker(int threads = 1) const {
        return std::make_unique<Process>(worker_command(threads), folder());
    }

    QueueStatus status() const { return QueueClient(address).status("fleet"); }

    // The task that one worker has been rendering for some time now.
    QueueStatus::Running wait_until_well_into_a_task() const {
        QueueStatus seen;
        wait_for("a task in mid-render", [&] {
            seen = status();
            return !seen.running.empty() && seen.running[0].since >= kWellIntoIt;
        });
        return seen.running.at(0);
    }
    void wait_until_done(std::int64_t n_tasks) const {
        wait_for("the end", [&] { return status().done == n_tasks; });
    }
    void wait_for(const std::string& what, const std::function<bool()>& condition) const {
        const auto end = std::chrono::steady_clock::now() + kPatience;
        while (!condition()) {
            if (std::chrono::steady_clock::now() > end) {
                throw std::runtime_error("waited in vain for " + what + "\n" +
                                         coordinator->err_so_far());
            }
            std::this_thread::sleep_for(milliseconds(10));
        }
    }

    std::string store_path() const { return folder_.path() / "store"; }
    std::string address_file() const { return folder_.path() / "address"; }
    const fs::path& folder() const { return folder_.path(); }
    Store look() const { return {store_path(), Store::Access::ReadOnly}; }
    void expect_every_result_once(const Plan& plan) const {
        const Store store = look();
        std::size_t n_runs = 0;
        for (const auto& entry : fs::directory_iterator(store.folder() / "runs")) {
            ++n_runs;
            EXPECT_TRUE(store.has_run(entry.path().filename())) << entry.path();
        }
        EXPECT_EQ(n_runs, plan.cells.size());
        EXPECT_EQ(store.run_summaries().size(), plan.cells.size());
        for (const Cell& cell : plan.cells) {
            const auto record = store.run(task_id(cell.task));
            ASSERT_TRUE(record.has_value());
            EXPECT_TRUE(record->valid);
            EXPECT_EQ(record->task, cell.task);
            EXPECT_EQ(store.task(record->run)->state, TaskState::Done);
        }
    }

    std::string address;
    std::unique_ptr<Process> coordinator;
};

Plan long_tasks() {
    const TimeBudget budget{kLongTaskSeconds, BudgetClock::Wall};
    return make_plan({cornell_box("path", 1, budget), cornell_box("path", 2, budget),
                      cornell_box("direct", 1, SampleBudget{2})});
}

TEST(Fleet, TaskOfAWorkerKilledInMidRenderIsDoneByAnother) {
    Fleet fleet;
    const Plan plan = long_tasks();
    EXPECT_EQ(QueueClient(fleet.address).submit(plan).tasks, 3);
    const auto victim = fleet.start_worker();
    const auto running = fleet.wait_until_well_into_a_task();
    send(*victim, SIGKILL);
    EXPECT_EQ(exit_code_of(*victim), 128 + SIGKILL);
    EXPECT_EQ(fleet.look().task(running.task)->state, TaskState::Leased) << "killed too late";

    const auto heir = fleet.start_worker();
    fleet.wait_until_done(3);
    fleet.expect_every_result_once(plan);
    const Store store = fleet.look();
    EXPECT_EQ(store.task(running.task)->losses, 1);
    EXPECT_NE(store.run(running.task)->worker, running.worker);
    send(*heir, SIGTERM);
    EXPECT_EQ(exit_code_of(*heir), 0);
    send(*fleet.coordinator, SIGTERM);
    EXPECT_EQ(exit_code_of(*fleet.coordinator), 0);
}

TEST(Fleet, CoordinatorKilledAndRestartedContinuesAndGetsTheFinishedResult) {
    Fleet fleet;
    const Plan plan = long_tasks();
    QueueClient(fleet.address).submit(plan);
    const auto worker = fleet.start_worker();
    const auto running = fleet.wait_until_well_into_a_task();
    const auto before = fleet.look().task(running.task);
    send(*fleet.coordinator, SIGKILL);
    EXPECT_EQ(exit_code_of(*fleet.coordinator), 128 + SIGKILL);

    // The render ends meanwhile; its result has to wait.
    std::this_thread::sleep_for(std::chrono::duration<double>(kLongTaskSeconds));
    EXPECT_FALSE(fleet.look().has_run(running.task));
    EXPECT_FALSE(is_dead(worker->pid()));
    fleet.start_coordinator(fleet.address);
    fleet.wait_until_done(3);
    fleet.expect_every_result_once(plan);
    const Store store = fleet.look();
    EXPECT_EQ(store.run(running.task)->epoch, before->epoch) << "it was rendered again";
    EXPECT_EQ(store.task(running.task)->losses, 0);
}

// The run's id → its pixels.
std::map<std::string, Image> images_by(int n_workers, int n_threads, const Plan& plan) {
    Fleet fleet;
    std::vector<std::unique_ptr<Process>> workers;
    for (int i = 0; i < n_workers; ++i) workers.push_back(fleet.start_worker(n_threads));
    QueueClient(fleet.address).submit(plan);
    fleet.wait_until_done(static_cast<std::int64_t>(plan.cells.size()));
    fleet.expect_every_result_once(plan);
    const Store store = fleet.look();
    std::map<std::string, Image> images;
    std::set<std::string> names;
    for (const Cell& cell : plan.cells) {
        images[task_id(cell.task)] = store.run_image(task_id(cell.task));
        names.insert(store.run(task_id(cell.task))->worker);
    }
    EXPECT_EQ(names.size(), static_cast<std::size_t>(n_workers)) << "some worker did nothing";
    return images;
}

TEST(Fleet, OneAndTwoWorkersRenderTheSameBits) {
    std::vector<Task> tasks;
    for (std::int64_t seed = 1; seed <= 6; ++seed) {
        tasks.push_back(cornell_box("path", seed, SampleBudget{256}));
        tasks.push_back(cornell_box("direct", seed, SampleBudget{256}));
    }
    const Plan plan = make_plan(tasks);
    const auto one = images_by(1, 1, plan);
    const auto two = images_by(2, 2, plan);
    EXPECT_EQ(one.size(), tasks.size());
    EXPECT_EQ(one, two);
    EXPECT_NE(one.at(task_id(tasks[0])), one.at(task_id(tasks[2]))) << "seeds make no difference";
}

TEST(Fleet, WorkerThatIsTerminatedGivesItsTaskBackWithoutBlame) {
    Fleet fleet;
    QueueClient(fleet.address).submit(long_tasks());
    const auto worker = fleet.start_worker();
    const auto running = fleet.wait_until_well_into_a_task();
    send(*worker, SIGTERM);
    EXPECT_EQ(exit_code_of(*worker), 0);
    const auto row = fleet.look().task(running.task);
    EXPECT_EQ(row->state, TaskState::Pending);
    EXPECT_EQ(row->failures, 0);
    EXPECT_EQ(row->losses, 0);
}

TEST(Fleet, TaskThatCannotBeDoneFailsWithAReason) {
    Fleet fleet;
    Task task = cornell_box("path", 1, SampleBudget{1});
    task.scene_hash = std::string(64, '0');
    QueueClient(fleet.address).submit(make_plan({task}));
    const auto worker = fleet.start_worker();
    fleet.wait_for("the failure", [&] { return fleet.status().failed == 1; });
    EXPECT_THAT(fleet.status().failures.at(0).error,
                testing::HasSubstr("it changed since the experiment was planned"));
    EXPECT_FALSE(is_dead(worker->pid()));
}

TEST(Fleet, SecondCoordinatorOnAStoreIsRefused) {
    Fleet fleet;
    Process second({MISBENCH_COORDINATOR, "--store", fleet.store_path()}, fleet.folder());
    EXPECT_EQ(exit_code_of(second), 3);
    EXPECT_THAT(second.err_so_far(), testing::HasSubstr("is in use by process"));
}

TEST(Fleet, SocketInUseIsRefusedAndOneThatACrashLeftIsTakenOver) {
    Fleet fleet;
    send(*fleet.coordinator, SIGTERM);
    EXPECT_EQ(exit_code_of(*fleet.coordinator), 0);
    const std::string address = "unix:" + (fleet.folder() / "socket").string();
    fleet.start_coordinator(address);
    EXPECT_EQ(fleet.address, address);
    Process thief({MISBENCH_COORDINATOR, "--store", fleet.folder() / "other", "--listen", address},
                  fleet.folder());
    EXPECT_EQ(exit_code_of(thief), 3);
    send(*fleet.coordinator, SIGKILL);
    exit_code_of(*fleet.coordinator);
    fleet.start_coordinator(address);
    QueueClient(address).submit(make_plan({cornell_box("path", 1, SampleBudget{1})}));
}

TEST(Fleet, AddressBeyondThisMachineIsRefusedUnlessAllowed) {
    const TemporaryFolder folder;
    Process coordinator(
        {MISBENCH_COORDINATOR, "--store", folder.path() / "store", "--listen", "0.0.0.0:0"},
        folder.path());
    EXPECT_EQ(exit_code_of(coordinator), 2);
    EXPECT_THAT(coordinator.err_so_far(), testing::HasSubstr("--allow-remote permits it"));
    EXPECT_FALSE(fs::exists(folder.path() / "store"));

    Process allowed({MISBENCH_COORDINATOR, "--store", folder.path() / "store", "--listen",
                     "0.0.0.0:0", "--allow-remote"},
                    folder.path());
    EXPECT_EQ(exit_code_of(allowed, seconds(1)), std::nullopt);
    send(allowed, SIGINT);
    EXPECT_EQ(exit_code_of(allowed), 0);
}

TEST(Fleet, WorkerGivesUpACoordinatorThatIsNotThere) {
    const TemporaryFolder folder;
    const std::string socket = folder.path() / "socket";
    Process worker({MISBENCH_WORKER, "--coordinator", "unix:" + socket, "--scratch",
                    folder.path() / "scratch", "--give-up-seconds", "1"},
                   folder.path());
    EXPECT_EQ(exit_code_of(worker), 4);
    EXPECT_THAT(worker.err_so_far(), testing::HasSubstr("no answer within 1000 ms"));
}

TEST(Client, SaysThatNobodyAnswersWithinItsDeadline) {
    QueueClient client("unix:/nonexistent/socket", milliseconds(200));
    const auto start = std::chrono::steady_clock::now();
    try {
        client.status("");
        FAIL() << "somebody answered";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), Errc::Unavailable);
        EXPECT_STREQ(error.what(),
                     "call coordinator at 'unix:/nonexistent/socket': no answer within 200 ms");
    }
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

TEST(Fleet, ChildrenDieWithTheirParentAlsoWhenItIsKilled) {
    Fleet fleet;
    const fs::path pid_file = fleet.folder() / "pid";
    std::string script;
    for (const std::string& word : fleet.worker_command(1)) script += "'" + word + "' ";
    script += "& echo $! > '" + pid_file.string() + ".new'; mv '" + pid_file.string() + ".new' '" +
              pid_file.string() + "'; wait";
    Process parent({"/bin/sh", "-c", script}, fleet.folder());
    fleet.wait_for("the worker's process id", [&] { return fs::exists(pid_file); });
    const pid_t pid = std::stoi(read_file(pid_file));
    // It has asked the kernel before it asks for work.
    QueueClient(fleet.address).submit(long_tasks());
    fleet.wait_until_well_into_a_task();
    ASSERT_FALSE(is_dead(pid));
    send(parent, SIGKILL);
    fleet.wait_for("the worker's death", [&] { return is_dead(pid); });
}

}  // namespace
}  // namespace misbench
