// What a task costs the coordinator: a lease and a commit, the fsyncs of the store included.
#include <benchmark/benchmark.h>
#include <spdlog/spdlog.h>

#include "coordinator/task_queue.h"
#include "renderer/base/build_info.h"
#include "tests/support/made_up_store.h"

namespace misbench {
namespace {

using std::chrono::steady_clock;

std::vector<TaskRow> rows(std::int64_t n) {
    std::vector<TaskRow> all;
    for (std::int64_t i = 0; i < n; ++i) {
        TaskRow row;
        row.id = "t" + std::to_string(i);
        row.block = "b" + std::to_string(i / 10);
        row.position = i;
        all.push_back(row);
    }
    return all;
}

// The argument is the size of the job table; its first half is done.
void grant_and_complete(benchmark::State& state) {
    const auto now = steady_clock::now();
    auto all = rows(state.range(0));
    for (std::size_t i = 0; i < all.size() / 2; ++i) all[i].state = TaskState::Done;
    LeaseTable table(all, {}, now);
    std::int64_t epoch = 0;
    for (auto _ : state) {
        auto lease = table.acquire("w", now, [&] { return ++epoch; });
        if (!lease) {
            state.PauseTiming();
            table = LeaseTable(all, {}, now);
            epoch = 0;
            state.ResumeTiming();
            continue;
        }
        table.complete(*lease, now);
    }
}
BENCHMARK(grant_and_complete)->Arg(100)->Arg(10'000)->Arg(100'000);

void lease_and_commit(benchmark::State& state) {
    spdlog::set_level(spdlog::level::warn);
    const TemporaryFolder folder;
    TaskQueue queue(Store(folder.path() / "store", Store::Access::ReadWrite), {},
                    steady_clock::now());
    int n_submitted = 0;
    for (auto _ : state) {
        auto instruction = queue.synchronize("w", build_id(), {}, steady_clock::now());
        state.PauseTiming();
        if (!std::holds_alternative<Instruction::Begin>(instruction.next)) {
            ++n_submitted;
            queue.submit(made_up_plan("plan" + std::to_string(n_submitted), 500 * n_submitted),
                         steady_clock::now());
            instruction = queue.synchronize("w", build_id(), {}, steady_clock::now());
        }
        const auto& begin = std::get<Instruction::Begin>(instruction.next);
        Record record = made_up_record(begin.task);
        write_exr(folder.path() / "image.exr", made_up_image(begin.task));
        const std::string image = read_file(folder.path() / "image.exr");
        record.image_sha256 = sha256_hex(image);
        const std::string json = record_to_json(record).dump();
        state.ResumeTiming();
        const auto now = steady_clock::now();
        queue.upload(begin.lease, "image.exr", 0, image, now);
        queue.upload(begin.lease, "record.json", 0, json, now);
        queue.commit(begin.lease,
                     {{"image.exr", static_cast<std::int64_t>(image.size()), record.image_sha256},
                      {"record.json", static_cast<std::int64_t>(json.size()), sha256_hex(json)}},
                     now);
    }
}
BENCHMARK(lease_and_commit)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace misbench
