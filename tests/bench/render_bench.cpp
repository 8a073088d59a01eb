// How much of `path`'s time is ray tracing: its rays per second, and the rays per second of the
// very same rays given to bare Embree, in one run on one thread.
#include <benchmark/benchmark.h>
#include <embree3/rtcore.h>

#include <array>
#include <vector>

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

constexpr std::array kScenes = {"VeachMIS/VeachMIS.json", "CornellBox/CornellBox.json",
                                "Box/LightCenter.json"};

std::string name_of(const benchmark::State& state) {
    return kScenes[static_cast<std::size_t>(state.range(0))];
}

const LoadedScene& scene_of(const benchmark::State& state) {
    static std::array<LoadedScene, kScenes.size()> scenes;
    LoadedScene& scene = scenes[static_cast<std::size_t>(state.range(0))];
    if (!scene.scene) scene = load_scene(std::string(MISBENCH_SCENES) + "/" + name_of(state), 1);
    return scene;
}

RenderResult render_once(const Scene& scene, std::int64_t samples) {
    return render(scene, {.method = "path",
                          .parameters = {},
                          .width = 320,
                          .height = 240,
                          .budget = SampleBudget{samples},
                          .seed = 1,
                          .threads = 1});
}

void path_rays(benchmark::State& state) {
    const LoadedScene& loaded = scene_of(state);
    std::int64_t n_rays = 0;
    for (auto _ : state) n_rays += render_once(*loaded.scene, 4).statistics.rays;
    state.SetItemsProcessed(n_rays);
    state.SetLabel(name_of(state));
}

// The same image by the render loop that is right for every scene.
void path_rays_general_loop(benchmark::State& state) {
    const LoadedScene loaded =
        load_scene(std::string(MISBENCH_SCENES) + "/" + name_of(state), 1, kAllFeatures);
    std::int64_t n_rays = 0;
    for (auto _ : state) n_rays += render_once(*loaded.scene, 4).statistics.rays;
    state.SetItemsProcessed(n_rays);
    state.SetLabel(name_of(state));
}

void bare_embree_rays(benchmark::State& state) {
    const LoadedScene& loaded = scene_of(state);
    std::vector<Query> queries;
    g_recording = &queries;
    render_once(*loaded.scene, 4);
    g_recording = nullptr;
    for (auto _ : state) {
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
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(queries.size()));
    state.SetLabel(name_of(state));
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

BENCHMARK(path_rays)->DenseRange(0, 2)->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);
BENCHMARK(path_rays_general_loop)
    ->DenseRange(0, 2)
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(bare_embree_rays)->DenseRange(0, 2)->Unit(benchmark::kMillisecond);
BENCHMARK(heuristic_weight)->DenseRange(0, 3);

}  // namespace
}  // namespace misbench
