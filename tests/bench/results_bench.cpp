// What the store costs beside rendering: a metric, and the commit of a run with its durable writes.
#include <benchmark/benchmark.h>

#include <random>

#include "results/metrics/metrics.h"
#include "tests/support/made_up_store.h"

namespace misbench {
namespace {

Image noise(int width, int height, unsigned seed) {
    Image image(width, height);
    std::mt19937 random(seed);
    std::gamma_distribution<float> gamma(2.0F, 0.5F);
    for (float& value : image.rgb) value = gamma(random);
    return image;
}

void metric_over_640x480(benchmark::State& state, const std::string& id) {
    const Image image = noise(640, 480, 1);
    const Image a = noise(640, 480, 2);
    const Image b = noise(640, 480, 3);
    const Metric& metric = find_metric(id);
    for (auto _ : state) benchmark::DoNotOptimize(measure(metric, image, {a, b}));
    state.SetItemsProcessed(state.iterations() * 640 * 480);
}
BENCHMARK_CAPTURE(metric_over_640x480, relmse, "relmse.eps0.01")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(metric_over_640x480, trimmed, "relmse.eps0.01.trim0.001")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(metric_over_640x480, ldr_flip, "flip.ldr.ppd67")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(metric_over_640x480, hdr_flip, "flip.hdr.ppd67")->Unit(benchmark::kMillisecond);

void commit_of_a_run(benchmark::State& state) {
    const TemporaryFolder folder;
    Store store(folder.path() / "store", Store::Access::ReadWrite);
    std::int64_t seed = 0;
    for (auto _ : state) {
        state.PauseTiming();
        Task task = made_up_task("plain", ++seed, SampleBudget{16});
        task.width = static_cast<int>(state.range(0));
        task.height = static_cast<int>(state.range(1));
        const auto staged = stage_made_up_run(store, task);
        state.ResumeTiming();
        store.commit_run(staged);
    }
}
// Wall time: most of it waits for the disk.
BENCHMARK(commit_of_a_run)
    ->Args({64, 48})
    ->Args({640, 480})
    ->Iterations(50)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void epoch_of_a_lease(benchmark::State& state) {
    const TemporaryFolder folder;
    Store store(folder.path() / "store", Store::Access::ReadWrite);
    for (auto _ : state) benchmark::DoNotOptimize(store.next_epoch());
}
BENCHMARK(epoch_of_a_lease)->UseRealTime()->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace misbench
