// Photon maps: what building them and asking them costs, on points that paths found on the surfaces
// of scenes, and the same by Embree's point queries over the same points.
#include <benchmark/benchmark.h>
#include <embree3/rtcore.h>

#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "renderer/base/rng.h"
#include "renderer/methods/thread_pool.h"
#include "renderer/paths/photon_map.h"
#include "renderer/scene/camera.h"
#include "renderer/scene/load.h"
#include "renderer/scene/scene.h"
#include "tests/support/lights.h"

namespace misbench {
namespace {

constexpr std::array kScenes = {"CornellBox/CornellBox.json", "ModernHall/ModernHall.json"};
constexpr int kWidth = 512;
constexpr int kHeight = 512;

// Where paths meet the scene that begin with the ray of their number and scatter to all sides.
template <class FirstRay>
std::vector<Vec3> vertices_of_paths(const Scene& scene, std::size_t n, int max_depth,
                                    const FirstRay& first_ray) {
    std::vector<Vec3> vertices;
    for (std::uint32_t path = 0; vertices.size() < n; ++path) {
        Rng rng(1, path, 0);
        Ray ray = first_ray(path, rng);
        for (int depth = 1; depth <= max_depth && vertices.size() < n; ++depth) {
            const auto hit = scene.closest(ray);
            if (!hit) break;
            vertices.push_back(hit->position);
            const Vec3 side = dot(hit->normal, ray.direction) < 0 ? hit->normal : -hit->normal;
            const Vec3 w = normalized(side + test::random_direction(rng));
            ray = {hit->leave(w), w};
        }
    }
    return vertices;
}

struct Data {
    std::vector<Vec3> photons;
    std::vector<Vec3> queries;
    float radius = 0;
};

float radius_for(const Data& data, double n_found, float largest) {
    ThreadPool threads(1);
    PhotonMap map;
    map.build(data.photons, threads);
    float low = 1e-6F * largest;
    float high = largest;
    for (int step = 0; step < 30; ++step) {
        const float radius = std::sqrt(low * high);
        std::size_t n = 0;
        std::size_t asked = 0;
        for (std::size_t i = 0; i < data.queries.size(); i += 997, ++asked) {
            map.query(data.queries[i], radius, [&](std::uint32_t, float) { ++n; });
        }
        (static_cast<double>(n) < n_found * static_cast<double>(asked) ? low : high) = radius;
    }
    return low;
}

// Arguments of a benchmark: scene, photons, tenths of photons found by a query, threads.
const Data& data_of(const benchmark::State& state) {
    static std::map<std::array<std::int64_t, 3>, Data> made;
    Data& data = made[{state.range(0), state.range(1), state.range(2)}];
    if (!data.photons.empty()) return data;
    const std::string file = kScenes[static_cast<std::size_t>(state.range(0))];
    const auto scene = load_scene(std::string(MISBENCH_SCENES) + "/" + file, 1).scene;
    const Camera camera(scene->camera(), kWidth, kHeight);
    const auto from_camera = [&](std::uint32_t path, Rng& rng) {
        const auto x = static_cast<float>(path % kWidth) + rng.uniform();
        const auto y = static_cast<float>(path / kWidth % kHeight) + rng.uniform();
        return camera.ray({x, y}, {});
    };
    const auto anywhere = [&](std::uint32_t path, Rng& rng) {
        return Ray{from_camera(path, rng).origin, test::random_direction(rng)};
    };
    data.photons = vertices_of_paths(*scene, static_cast<std::size_t>(state.range(1)), 5, anywhere);
    data.queries = vertices_of_paths(*scene, kWidth * kHeight * 2, 2, from_camera);
    data.radius = radius_for(data, 0.1 * static_cast<double>(state.range(2)), scene->radius());
    return data;
}

// Every primitive of one user geometry is a point.
class EmbreePoints {
 public:
    void build(const std::vector<Vec3>& points, ThreadPool& threads) {
        // In this order: the scene goes before its device.
        scene_.reset();
        device_.reset(rtcNewDevice(("threads=" + std::to_string(threads.size())).c_str()));
        points_ = &points;
        scene_.reset(rtcNewScene(device_.get()));
        const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_USER);
        rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(points.size()));
        rtcSetGeometryUserData(geometry, const_cast<Vec3*>(points.data()));
        rtcSetGeometryBoundsFunction(
            geometry,
            [](const RTCBoundsFunctionArguments* args) {
                const Vec3 p = static_cast<const Vec3*>(args->geometryUserPtr)[args->primID];
                *args->bounds_o = {p.x, p.y, p.z, 0, p.x, p.y, p.z, 0};
            },
            nullptr);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_.get(), geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_.get());
    }

    template <class Found>
    void query(Vec3 centre, float radius, const Found& found) const {
        struct Search {
            const Vec3* points;
            const Found& found;
        } search{points_->data(), found};
        RTCPointQuery query{centre.x, centre.y, centre.z, 0, radius};
        RTCPointQueryContext context;
        rtcInitPointQueryContext(&context);
        const auto visit = [](RTCPointQueryFunctionArguments* args) {
            const auto& s = *static_cast<Search*>(args->userPtr);
            const RTCPointQuery& q = *args->query;
            const Vec3 d = s.points[args->primID] - Vec3{q.x, q.y, q.z};
            if (dot(d, d) < q.radius * q.radius) s.found(args->primID, dot(d, d));
            return false;
        };
        rtcPointQuery(scene_.get(), &query, &context, visit, &search);
    }

 private:
    struct Release {
        void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
        void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
    };
    std::unique_ptr<std::remove_pointer_t<RTCDevice>, Release> device_;
    std::unique_ptr<std::remove_pointer_t<RTCScene>, Release> scene_;
    const std::vector<Vec3>* points_ = nullptr;
};

template <class Map>
void build(benchmark::State& state) {
    const Data& data = data_of(state);
    ThreadPool threads(static_cast<int>(state.range(3)));
    Map map;
    for (auto _ : state) map.build(data.photons, threads);
    state.SetItemsProcessed(state.iterations() * state.range(1));
}

template <class Map>
void query(benchmark::State& state) {
    const Data& data = data_of(state);
    ThreadPool threads(static_cast<int>(state.range(3)));
    Map map;
    map.build(data.photons, threads);
    constexpr std::size_t kChunk = 4096;
    const std::size_t n_chunks = data.queries.size() / kChunk;
    std::vector<std::size_t> n_found(n_chunks);
    for (auto _ : state) {
        threads.for_each(
            n_chunks, [] { return false; },
            [&](std::size_t chunk) {
                std::size_t n = 0;
                float sum = 0;
                for (std::size_t i = chunk * kChunk; i < (chunk + 1) * kChunk; ++i) {
                    map.query(data.queries[i], data.radius, [&](std::uint32_t, float distance2) {
                        ++n;
                        sum += distance2;
                    });
                }
                benchmark::DoNotOptimize(sum);
                n_found[chunk] = n;
            });
    }
    std::size_t n = 0;
    for (const std::size_t found : n_found) n += found;
    const auto n_queries = static_cast<std::int64_t>(n_chunks * kChunk);
    state.SetItemsProcessed(state.iterations() * n_queries);
    state.counters["found"] = static_cast<double>(n) / static_cast<double>(n_queries);
}

void builds(benchmark::internal::Benchmark* b) {
    b->ArgsProduct({{0, 1}, {100'000, 1'000'000}, {100}, {1, 2}})
        ->MeasureProcessCPUTime()
        ->UseRealTime();
    b->Unit(benchmark::kMillisecond);
}
void queries(benchmark::internal::Benchmark* b) {
    b->ArgsProduct({{0, 1}, {100'000, 1'000'000}, {1, 10, 100, 1000}, {1, 2}})
        ->MeasureProcessCPUTime()
        ->UseRealTime();
    b->Unit(benchmark::kMillisecond);
}

BENCHMARK(build<PhotonMap>)->Apply(builds);
BENCHMARK(build<EmbreePoints>)->Apply(builds);
BENCHMARK(query<PhotonMap>)->Apply(queries);
BENCHMARK(query<EmbreePoints>)->Apply(queries);

}  // namespace
}  // namespace misbench
