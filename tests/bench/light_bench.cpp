// What choosing a light costs, by the number of lights: building, choosing, asking for a
// probability.
#include <benchmark/benchmark.h>

#include "renderer/scene/light_sampler.h"
#include "tests/support/lights.h"

namespace misbench {
namespace {

struct Case {
    std::vector<LightBounds> lights;
    const LightSelection& selection;
};

Case case_of(benchmark::State& state) {
    const LightSelection& selection = light_selections()[static_cast<std::size_t>(state.range(0))];
    state.SetLabel(std::string(selection.name));
    return {test::random_lamps(static_cast<int>(state.range(1)), 1, 1), selection};
}

void build(benchmark::State& state) {
    const auto [lights, selection] = case_of(state);
    for (auto _ : state) benchmark::DoNotOptimize(LightSampler(lights, selection));
}

void select(benchmark::State& state) {
    const auto [lights, selection] = case_of(state);
    const LightSampler sampler(lights, selection);
    Rng rng(2, 0, 0);
    for (auto _ : state) {
        const Vec3 from = test::random_point(rng, 1);
        benchmark::DoNotOptimize(sampler.select(from, double{rng.uniform()}));
    }
}

void probability(benchmark::State& state) {
    const auto [lights, selection] = case_of(state);
    const LightSampler sampler(lights, selection);
    Rng rng(2, 0, 0);
    for (auto _ : state) {
        const Vec3 from = test::random_point(rng, 1);
        const auto light =
            static_cast<std::uint32_t>(rng.uniform() * static_cast<float>(state.range(1)));
        benchmark::DoNotOptimize(sampler.probability(light, from));
    }
}

BENCHMARK(build)->ArgsProduct({{0, 1, 2, 3}, {1000, 1'000'000}})->Unit(benchmark::kMillisecond);
BENCHMARK(select)->ArgsProduct({{0, 1, 2, 3}, {10, 1000, 1'000'000}});
BENCHMARK(probability)->ArgsProduct({{0, 1, 2, 3}, {10, 1000, 1'000'000}});

}  // namespace
}  // namespace misbench
