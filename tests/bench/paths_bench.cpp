// What a weight costs: the effective densities of all techniques and the heuristic, directly and
// through the seams that factors and observers enter by.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <ctime>
#include <limits>
#include <vector>

#include "renderer/methods/render_loop.h"
#include "renderer/paths/path_weights.h"
#include "renderer/scene/load.h"
#include "renderer/scene/scene.h"
#include "tests/support/random_paths.h"

namespace misbench {
namespace {

// All techniques of `vcm` at 640 x 480.
constexpr TechniqueCounts kCounts{.light = 307'200, .connect = 0.2, .merge = 307'200};

// Paths of as many edges as the first argument says, each with the technique that made it.
struct Paths {
    explicit Paths(const benchmark::State& state) {
        const auto n_edges = static_cast<int>(state.range(0));
        test::RandomPaths random(1);
        for (int i = 0; i < 256; ++i) {
            densities.push_back(random.path(n_edges, 3, 0, 0.1).densities);
            techniques.push_back({TechniqueKind::Hit});  // always possible
        }
    }
    std::vector<PathDensities> densities;
    std::vector<Technique> techniques;
};

DensityPrecision precision_of(const benchmark::State& state) {
    return state.range(1) == 0 ? DensityPrecision::Double : DensityPrecision::Float;
}

template <class Weigh>
void measure(benchmark::State& state, const Weigh& weigh) {
    const Paths paths(state);
    for (auto _ : state) {
        for (std::size_t i = 0; i < paths.densities.size(); ++i) {
            benchmark::DoNotOptimize(weigh(paths.densities[i], paths.techniques[i]));
        }
    }
    const auto n = static_cast<std::int64_t>(paths.densities.size());
    state.SetItemsProcessed(state.iterations() * n);
    state.SetLabel(precision_of(state) == DensityPrecision::Double ? "double" : "float");
}

// The heuristic alone, on effective densities that are there.
void heuristic(benchmark::State& state) {
    const Heuristic balance = Heuristic::parse("balance");
    DensityScratch<double> scratch;
    const Paths paths(state);
    const auto q = effective_densities(paths.densities[0], kCounts, scratch);
    measure(state, [&](const PathDensities&, Technique) { return balance.weight(q, 0); });
}

template <class Real>
void densities_and_heuristic(benchmark::State& state) {
    const Heuristic balance = Heuristic::parse("balance");
    DensityScratch<Real> scratch;
    measure(state, [&](const PathDensities& path, Technique technique) {
        const auto q = effective_densities(path, kCounts, scratch);
        return balance.weight(q, static_cast<std::size_t>(technique.index(path.n_edges)));
    });
}

void direct(benchmark::State& state) {
    if (precision_of(state) == DensityPrecision::Double) {
        densities_and_heuristic<double>(state);
    } else {
        densities_and_heuristic<float>(state);
    }
}

void weigh(benchmark::State& state, const PathWeights& weights) {
    PathWeights::Scratch scratch;
    measure(state, [&](const PathDensities& path, Technique technique) {
        return weights.weigh({.densities = &path}, kCounts, technique, scratch).w;
    });
}

void without_providers(benchmark::State& state) {
    weigh(state, PathWeights(Heuristic::parse("balance"), precision_of(state)));
}

class AllOnes final : public FactorProvider {
    void multiply(const PathView&, const TechniqueCounts&, std::span<double>) const override {}
};

void with_a_provider(benchmark::State& state) {
    PathWeights weights(Heuristic::parse("balance"), precision_of(state));
    weights.add(std::make_shared<AllOnes>());
    weigh(state, weights);
}

// `bdpt` with an observer that does nothing and without one, in turns; the counters are of the
// fastest turn of each. Argument: whether the observer wants samples without a contribution.
void observed_bdpt(benchmark::State& state) {
    class DoesNothing final : public SampleObserver {
     public:
        explicit DoesNothing(bool wants_zeros) : wants_zeros_(wants_zeros) {}
        bool wants_zeros() const override { return wants_zeros_; }
        void observe(const Sample& sample, std::size_t) override {
            benchmark::DoNotOptimize(sample.weight);
        }

     private:
        bool wants_zeros_;
    };
    const LoadedScene loaded =
        load_scene(std::string(MISBENCH_SCENES) + "/VeachBidir/VeachBidir.json", 1);
    DoesNothing does_nothing(state.range(0) != 0);
    const auto seconds_with = [&](SampleObserver* observer) {
        const std::clock_t start = std::clock();
        render(*loaded.scene, {.method = "bdpt",
                               .parameters = {},
                               .width = 320,
                               .height = 240,
                               .budget = SampleBudget{4},
                               .seed = 1,
                               .threads = 1,
                               .observer = observer});
        return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    };
    double with = std::numeric_limits<double>::infinity();
    double without = with;
    for (auto _ : state) {
        const double seconds = seconds_with(&does_nothing);
        state.SetIterationTime(seconds);
        with = std::min(with, seconds);
        without = std::min(without, seconds_with(nullptr));
    }
    state.counters["seconds without"] = without;
    state.counters["seconds with"] = with;
    state.SetLabel(state.range(0) != 0 ? "with zeros" : "");
}

void path_lengths(benchmark::internal::Benchmark* b) { b->ArgsProduct({{2, 5, 10, 100}, {0, 1}}); }

BENCHMARK(heuristic)->ArgsProduct({{2, 5, 10, 100}, {0}});
BENCHMARK(direct)->Apply(path_lengths);
BENCHMARK(without_providers)->Apply(path_lengths);
BENCHMARK(with_a_provider)->Apply(path_lengths);
BENCHMARK(observed_bdpt)
    ->DenseRange(0, 1)
    ->UseManualTime()
    ->Iterations(7)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace misbench
