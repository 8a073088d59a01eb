#include "experiments/cli/local_run.h"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <set>

#include "experiments/analysis/comparison.h"
#include "experiments/cli/fleet.h"
#include "experiments/cli/output.h"
#include "experiments/cli/progress.h"
#include "experiments/cost_model.h"
#include "experiments/report/claims_formats.h"
#include "experiments/report/provenance.h"
#include "experiments/report/table_formats.h"
#include "proto/client.h"
#include "renderer/base/error.h"
#include "renderer/base/log.h"

namespace misbench {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kTick{100};
constexpr milliseconds kStatusInterval{500};
constexpr std::chrono::seconds kAnswerWithin{3};
constexpr std::chrono::seconds kStartWithin{30};

// SIGINT, SIGTERM and SIGHUP, taken by whoever waits and delivered to nobody meanwhile.
class Interrupts {
 public:
    Interrupts() {
        ::sigemptyset(&signals_);
        for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::sigaddset(&signals_, signal);
        ::pthread_sigmask(SIG_BLOCK, &signals_, &before_);
    }
    ~Interrupts() {
        // One that nobody took must not end us now.
        while (wait(milliseconds(0))) {
        }
        ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
    }
    Interrupts(const Interrupts&) = delete;
    Interrupts& operator=(const Interrupts&) = delete;

    // True when one came within `duration`.
    bool wait(milliseconds duration) const {
        const timespec time{.tv_sec = duration.count() / 1000,
                            .tv_nsec = duration.count() % 1000 * 1'000'000};
        return ::sigtimedwait(&signals_, nullptr, &time) > 0;
    }

 private:
    sigset_t signals_{};
    sigset_t before_{};
};

std::set<std::string> task_ids(const Plan& plan) {
    std::set<std::string> ids;
    for (const Cell& cell : plan.cells) ids.insert(task_id(cell.task));
    return ids;
}

// What is not in the store yet, with its cost on a worker of so many threads.
std::map<std::string, Cost> costs_to_do(const Store& store, const Plan& plan, int threads) {
    CostModel model(&store);
    std::map<std::string, Cost> costs;
    for (const Cell& cell : plan.cells) {
        const std::string id = task_id(cell.task);
        if (store.has_run(id)) continue;
        const auto* time = std::get_if<TimeBudget>(&cell.task.budget);
        const bool is_wall = time != nullptr && time->clock == BudgetClock::Wall;
        costs[id] = model.estimate(cell.task);
        if (!is_wall) costs[id].seconds /= threads;
    }
    return costs;
}

// The coordinator and the workers at work on one plan.
class LocalRun {
 public:
    LocalRun(const RunOptions& options, const Plan& plan, std::map<std::string, Cost> costs,
             const std::string& round, const Interrupts& interrupts)
        : plan_(plan),
          interrupts_(interrupts),
          fleet_({.store = options.store,
                  .workers = options.workers,
                  .threads_per_worker = options.threads_per_worker}),
          client_(fleet_.address(), kAnswerWithin),
          progress_(progress_mode(options.progress),
                    RemainingTime(std::move(costs), options.workers), round) {}

    // Returns when all tasks are done or failed, or no worker is left (true), or when interrupted
    // (false).
    bool work() {
        const bool went_on = start() && watch();
        progress_.clear();
        if (!went_on) print_note("interrupted: stopping the workers (again to stop at once)");
        stop();
        progress_.finish(status_);
        return went_on;
    }

 private:
    bool start() {
        const auto deadline = steady_clock::now() + kStartWithin;
        while (!fleet_.is_coordinator_ready()) {
            if (interrupts_.wait(kTick)) return false;
            tend();
            if (steady_clock::now() > deadline) {
                throw Error(Errc::Unavailable, "start the coordinator: not ready in time");
            }
        }
        client_.submit(plan_);
        fleet_.start_workers();
        return true;
    }

    bool watch() {
        auto next_status = steady_clock::now();
        auto last_answer = next_status;
        while (true) {
            if (interrupts_.wait(kTick)) return false;
            tend();
            if (!fleet_.has_workers()) return true;
            if (steady_clock::now() < next_status) continue;
            try {
                status_ = client_.status(plan_.experiment);
                last_answer = steady_clock::now();
            } catch (const Error& e) {
                // It may be on its way back.
                const bool is_lost = steady_clock::now() - last_answer > kStartWithin;
                if (e.code() != Errc::Unavailable || is_lost) throw;
                continue;
            }
            progress_.show(status_, last_answer);
            if (status_.pending + status_.leased == 0) return true;
            next_status = last_answer + kStatusInterval;
        }
    }

    void tend() {
        for (const std::string& note : fleet_.tend()) {
            progress_.clear();
            spdlog::warn("{}", note);
        }
    }

    void stop() {
        fleet_.ask_to_stop();
        while (!fleet_.is_stopped()) {
            if (interrupts_.wait(kTick)) fleet_.kill();
        }
    }

    const Plan& plan_;
    const Interrupts& interrupts_;
    Fleet fleet_;
    QueueClient client_;
    Progress progress_;
    QueueStatus status_;
};

// The store is locked here only while no coordinator runs.
std::map<std::string, Cost> put_experiment(const RunOptions& options, const Plan& plan) {
    Store store(options.store, Store::Access::ReadWrite);
    store.put_experiment(plan);
    return costs_to_do(store, plan, options.threads_per_worker);
}

}  // namespace

bool do_tasks(const RunOptions& options, const Plan& plan, const std::string& progress) {
    std::map<std::string, Cost> costs = put_experiment(options, plan);
    if (costs.empty()) return true;
    const Interrupts interrupts;
    return LocalRun(options, plan, std::move(costs), progress, interrupts).work();
}

bool report_failures(const Store& store, const Plan& plan) {
    std::map<std::string, const Cell*> cells;
    for (const Cell& cell : plan.cells) cells.emplace(task_id(cell.task), &cell);
    std::vector<std::string> lines;
    int n_unfinished = 0;
    for (const TaskRow& row : store.tasks()) {
        const auto known = cells.find(row.id);
        if (known == cells.end() || row.state == TaskState::Done) continue;
        if (row.state != TaskState::Failed) {
            ++n_unfinished;
            continue;
        }
        const Cell& cell = *known->second;
        lines.push_back(fmt::format("task failed: {}, {}, {}, seed {}: {}", cell.scene, cell.method,
                                    to_string(cell.budget), cell.seed, row.error));
    }
    if (n_unfinished > 0) {
        lines.push_back(fmt::format("{} tasks are unfinished: no worker is left; see {}",
                                    n_unfinished, (store.folder() / "logs").string()));
    }
    for (const std::string& line : lines) print_error(line);
    return !lines.empty();
}

int print_outcome(const Store& store, const Plan& plan) {
    const Table table =
        make_table(compare(store, plan), {}, provenance_lines(store, plan.experiment));
    print_result(to_text(table));
    if (!plan.claims.empty()) {
        print_result("\n" + claims_to_text({{plan.experiment, judge_claims(store, plan)}}));
    }
    return report_failures(store, plan) ? kExitSomeFailed : 0;
}

int interrupted(const Store& store, const Plan& plan, const RunOptions& options) {
    int n_done = 0;
    const std::set<std::string> ids = task_ids(plan);
    for (const std::string& id : ids) n_done += store.has_run(id) ? 1 : 0;
    print_note(fmt::format("interrupted: {} of {} tasks are done and kept; resume with: {}", n_done,
                           ids.size(), options.command_line));
    return kExitInterrupted;
}

}  // namespace misbench
