// How much of a method's time is ray tracing: its rays per second, and the rays per second of the
// very same rays given to bare Embree, in one run on one thread.
#include <benchmark/benchmark.h>
#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "experiments/statistics/intervals.h"
#include "renderer/methods/render_loop.h"
#include "renderer/mis/heuristics.h"
#include "renderer/scene/load.h"
#include "renderer/scene/scene.h"

namespace {

// Every query of the renderer passes through here (linker option --wrap), so that it can be kept
// and replayed without a hook in the product.
struct Query {
    RTCScene scene;
    RTCRay ray;
    bool shadow;
};
std::vector<Query>* g_recording = nullptr;

}  // namespace

extern "C" {
void __real_rtcIntersect1(RTCScene, RTCIntersectContext*, RTCRayHit*);
void __real_rtcOccluded1(RTCScene, RTCIntersectContext*, RTCRay*);
void __wrap_rtcIntersect1(RTCScene scene, RTCIntersectContext* context, RTCRayHit* query) {
    if (g_recording != nullptr) g_recording->push_back({scene, query->ray, false});
    __real_rtcIntersect1(scene, context, query);
}
void __wrap_rtcOccluded1(RTCScene scene, RTCIntersectContext* context, RTCRay* ray) {
    if (g_recording != nullptr) g_recording->push_back({scene, *ray, true});
    __real_rtcOccluded1(scene, context, ray);
}
}

namespace misbench {
namespace {

struct Method {
    const char* label;
    const char* name;
    ParameterMap parameters;
};
const std::array kMethods = {
    Method{"path", "path", {}},
    Method{"light", "light", {}},
    Method{"bdpt cache", "bdpt", {}},
    Method{"bdpt path", "bdpt", {{"pairing", std::string("path")}}},
    Method{"photon", "photon", {}},
    Method{"vcm", "vcm", {}},
};
constexpr std::array kScenes = {"VeachBidir/VeachBidir.json",   "ModernHall/ModernHall.json",
                                "DiningRoom2/DiningRoom2.json", "VeachMIS/VeachMIS.json",
                                "CornellBox/CornellBox.json",   "Box/LightCenter.json"};

// Arguments of a benchmark: scene, method.
std::string scene_name(const benchmark::State& state) {
    return kScenes[static_cast<std::size_t>(state.range(0))];
}
const Method& method_of(const benchmark::State& state) {
    return kMethods[static_cast<std::size_t>(state.range(1))];
}

const LoadedScene& scene_of(const benchmark::State& state) {
    static std::array<LoadedScene, kScenes.size()> scenes;
    LoadedScene& scene = scenes[static_cast<std::size_t>(state.range(0))];
    if (!scene.scene) scene = load_scene(std::string(MISBENCH_SCENES) + "/" + scene_name(state), 1);
    return scene;
}

RenderRequest request_of(const Method& method) {
    return {.method = method.name,
            .parameters = method.parameters,
            .width = 320,
            .height = 240,
            .budget = SampleBudget{4},
            .seed = 1,
            .threads = 1};
}

RenderResult render_once(const Scene& scene, const Method& method) {
    return render(scene, request_of(method));
}

void replay(const std::vector<Query>& queries) {
    for (const Query& query : queries) {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        if (query.shadow) {
            RTCRay ray = query.ray;
            __real_rtcOccluded1(query.scene, &context, &ray);
            benchmark::DoNotOptimize(ray.tfar);
        } else {
            RTCRayHit hit{};
            hit.ray = query.ray;
            hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
            __real_rtcIntersect1(query.scene, &context, &hit);
            benchmark::DoNotOptimize(hit.ray.tfar);
        }
    }
}

// CPU seconds of the process: a pass' serial parts are outside the render threads.
template <class Work>
double seconds_of(const Work& work) {
    const std::clock_t start = std::clock();
    work();
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

// The method and the replay of its rays take turns, so that a neighbour on the machine meets both;
// the counters are of the fastest turn of each.
void rays(benchmark::State& state) {
    const Scene& scene = *scene_of(state).scene;
    const Method& method = method_of(state);
    std::vector<Query> queries;
    g_recording = &queries;
    render_once(scene, method);
    g_recording = nullptr;
    double fastest_render = std::numeric_limits<double>::infinity();
    double fastest_replay = fastest_render;
    for (auto _ : state) {
        const double seconds = seconds_of([&] { render_once(scene, method); });
        state.SetIterationTime(seconds);
        fastest_render = std::min(fastest_render, seconds);
        fastest_replay = std::min(fastest_replay, seconds_of([&] { replay(queries); }));
    }
    const double n_millions = 1e-6 * static_cast<double>(queries.size());
    state.counters["Mrays/s"] = n_millions / fastest_render;
    state.counters["Embree Mrays/s"] = n_millions / fastest_replay;
    state.counters["Embree %"] = 100 * fastest_replay / fastest_render;
    state.counters["rays/sample"] = static_cast<double>(queries.size()) / (4 * 320 * 240);
    state.SetLabel(method.label + std::string(", ") + scene_name(state));
}

// What snapshots cost of a render's CPU time, for the densest ladder (after 1, 2, 4, 8 of 16
// passes): a render with them and one without take turns, each in front of the other by turns. The
// first counter is of all CPU time; the second only of what the renders' clocks did not count,
// which is where snapshots are made and which nothing disturbs. Both with half of their 95 %
// intervals over the turns.
void snapshots(benchmark::State& state) {
    const Scene& scene = *scene_of(state).scene;
    RenderRequest without = request_of(method_of(state));
    without.width = 160;
    without.height = 120;
    without.budget = SampleBudget{16};
    RenderRequest with = without;
    with.snapshots = SnapshotLadder{};
    struct Turn {
        double seconds;
        double uncounted;
    };
    const auto turn = [&scene](const RenderRequest& request) {
        double counted = 0;
        const double seconds =
            seconds_of([&] { counted = render(scene, request).statistics.cpu_seconds; });
        return Turn{seconds, seconds - counted};
    };
    std::vector<double> all;
    std::vector<double> uncounted;
    bool is_with_first = false;
    for (auto _ : state) {
        const Turn first = turn(is_with_first ? with : without);
        const Turn second = turn(is_with_first ? without : with);
        const Turn& a = is_with_first ? first : second;
        const Turn& b = is_with_first ? second : first;
        is_with_first = !is_with_first;
        all.push_back(100 * (a.seconds / b.seconds - 1));
        uncounted.push_back(100 * (a.uncounted - b.uncounted) / b.seconds);
        state.SetIterationTime(a.seconds);
    }
    for (const auto& [name, percents] : {std::pair("all", all), std::pair("made", uncounted)}) {
        const Estimate mean = estimate_mean(percents).value();
        state.counters[std::string(name) + " %"] = mean.value;
        if (!mean.interval) continue;
        state.counters[std::string(name) + " ± %"] = mean.interval->high - mean.value;
    }
    state.SetLabel(method_of(state).label + std::string(", ") + scene_name(state));
}

// The same image by the render loop that is right for every scene.
void rays_general_loop(benchmark::State& state) {
    const LoadedScene loaded =
        load_scene(std::string(MISBENCH_SCENES) + "/" + scene_name(state), 1, kAllFeatures);
    std::int64_t n_rays = 0;
    for (auto _ : state) n_rays += render_once(*loaded.scene, method_of(state)).statistics.rays;
    state.SetItemsProcessed(n_rays);
    state.SetLabel(method_of(state).label + std::string(", ") + scene_name(state));
}

void heuristic_weight(benchmark::State& state) {
    const MisHeuristic& row = heuristics()[static_cast<std::size_t>(state.range(0))];
    const Heuristic heuristic = Heuristic::parse(std::string(row.name));
    std::array q = {1.5, 2.5};
    for (auto _ : state) {
        benchmark::DoNotOptimize(q);
        benchmark::DoNotOptimize(heuristic.weight(q, 0));
    }
    state.SetLabel(std::string(row.name));
}

BENCHMARK(rays)
    ->ArgsProduct({{0, 1, 2}, benchmark::CreateDenseRange(0, 5, 1)})
    ->ArgsProduct({{3, 4, 5}, {0}})
    ->UseManualTime()
    ->Iterations(5)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(snapshots)
    ->ArgsProduct({{4}, {0, 5}})
    ->UseManualTime()
    ->Iterations(20)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(rays_general_loop)
    ->ArgsProduct({{3, 4, 5}, {0}})
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(heuristic_weight)->DenseRange(0, 4);

}  // namespace
}  // namespace misbench
