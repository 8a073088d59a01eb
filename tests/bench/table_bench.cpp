// What a table of a million stored measurements costs: opening the store, reading, statistics and
// layout, with rollups and without. The limit is 200 ms for the whole command.
#include <benchmark/benchmark.h>

#include "experiments/report/provenance.h"
#include "experiments/report/table_formats.h"
#include "results/rollup.h"
#include "tests/support/made_up_rows.h"
#include "tests/support/temporary_folder.h"

namespace misbench {
namespace {

// Made once: 20 scenes, 10 methods, 1000 seeds, 5 metrics.
const std::filesystem::path& million() {
    static const TemporaryFolder folder;
    static const std::filesystem::path store = [] {
        const std::filesystem::path made = folder.path() / "store";
        make_rows(made, {});
        return made;
    }();
    return store;
}

std::string table_of_a_store(const std::filesystem::path& folder) {
    const Store store(folder, Store::Access::ReadOnly);
    const Plan plan = store.experiment_head("");
    const Table table =
        make_table(compare(store, plan), {}, provenance_lines(store, plan.experiment));
    return to_text(table);
}

void table_from_rows(benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(table_of_a_store(million()));
}
BENCHMARK(table_from_rows)->Unit(benchmark::kMillisecond)->Iterations(3);

void making_rollups(benchmark::State& state) {
    const auto database = open_database(million() / "results.sqlite", Database::Access::ReadWrite);
    for (auto _ : state) {
        database->execute("UPDATE experiments SET rolled_up = 0");
        roll_up(*database);
    }
}
BENCHMARK(making_rollups)->Unit(benchmark::kMillisecond)->Iterations(1);

void table_from_rollups(benchmark::State& state) {
    roll_up(*open_database(million() / "results.sqlite", Database::Access::ReadWrite));
    for (auto _ : state) benchmark::DoNotOptimize(table_of_a_store(million()));
}
BENCHMARK(table_from_rollups)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace misbench
