#include "renderer/embree/accelerator.h"

#include <embree3/rtcore.h>

#include <limits>

#include "renderer/base/check.h"
#include "renderer/base/error.h"

namespace misbench {
namespace {

// A shadow segment ends short of its far end by this part of its length: the ends are offset from
// their surfaces already, this covers the rounding of the direction alone.
constexpr float kSegmentEnd = 1 - 4 * std::numeric_limits<float>::epsilon();

RTCRay make_ray(const Ray& ray, float far) {
    RTCRay r{};
    r.org_x = ray.origin.x, r.org_y = ray.origin.y, r.org_z = ray.origin.z;
    r.dir_x = ray.direction.x, r.dir_y = ray.direction.y, r.dir_z = ray.direction.z;
    r.tnear = 0;
    r.tfar = far;
    r.mask = ~0U;  // Debian's Embree has ray masks on; 0 would never hit
    return r;
}

void throw_on_error(RTCDevice device, const char* attempt) {
    if (const RTCError error = rtcGetDeviceError(device); error != RTC_ERROR_NONE) {
        throw Error(Errc::Internal, std::string(attempt) + ": Embree error " +
                                        std::to_string(static_cast<int>(error)));
    }
}

void bound_quadric(const RTCBoundsFunctionArguments* args) {
    const QuadricShape& quadric =
        static_cast<const QuadricShape*>(args->geometryUserPtr)[args->primID];
    const Vec3 lower = quadric.lower();
    const Vec3 upper = quadric.upper();
    *args->bounds_o = {lower.x, lower.y, lower.z, 0, upper.x, upper.y, upper.z, 0};
}

// Of a ray with the quadric that Embree asks about.
std::optional<float> intersect_quadric(const void* quadrics, unsigned primitive,
                                       const RTCRay& ray) {
    return static_cast<const QuadricShape*>(quadrics)[primitive].intersect(
        {ray.org_x, ray.org_y, ray.org_z}, {ray.dir_x, ray.dir_y, ray.dir_z}, ray.tnear, ray.tfar);
}

// Embree calls these with one ray at a time, because that is how it is asked.
void closest_on_quadric(const RTCIntersectFunctionNArguments* args) {
    if (args->valid[0] == 0) return;
    auto* query = reinterpret_cast<RTCRayHit*>(args->rayhit);
    const auto t = intersect_quadric(args->geometryUserPtr, args->primID, query->ray);
    if (!t) return;
    query->ray.tfar = *t;
    query->hit.geomID = args->geomID;
    query->hit.primID = args->primID;
}

void occluded_by_quadric(const RTCOccludedFunctionNArguments* args) {
    if (args->valid[0] == 0) return;
    auto* ray = reinterpret_cast<RTCRay*>(args->ray);
    if (intersect_quadric(args->geometryUserPtr, args->primID, *ray)) {
        ray->tfar = -std::numeric_limits<float>::infinity();
    }
}

constexpr unsigned kTriangles = 0;  // Embree's numbers of the two geometries
constexpr unsigned kQuadrics = 1;

}  // namespace

void Accelerator::Release::operator()(RTCDeviceTy* device) const { rtcReleaseDevice(device); }
void Accelerator::Release::operator()(RTCSceneTy* scene) const { rtcReleaseScene(scene); }

Accelerator::Accelerator(std::span<const Vec3> vertices,
                         std::span<const std::array<std::uint32_t, 3>> triangles,
                         std::span<const QuadricShape> quadrics, int build_threads)
    : device_(rtcNewDevice(("threads=" + std::to_string(build_threads)).c_str())) {
    MISBENCH_CHECK(device_);
    MISBENCH_CHECK(!vertices.empty());
    scene_.reset(rtcNewScene(device_.get()));
    // Robust traversal: no ray slips between triangles that share an edge.
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
    if (!triangles.empty()) {
        const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                   vertices.data(), 0, sizeof(Vec3), vertices.size() - 1);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                   triangles.data(), 0, sizeof triangles[0], triangles.size());
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene_.get(), geometry, kTriangles);
        rtcReleaseGeometry(geometry);
    }
    if (!quadrics.empty()) {
        const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_USER);
        rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(quadrics.size()));
        // Embree hands the pointer back to our functions, which only read.
        rtcSetGeometryUserData(geometry, const_cast<QuadricShape*>(quadrics.data()));
        rtcSetGeometryBoundsFunction(geometry, bound_quadric, nullptr);
        rtcSetGeometryIntersectFunction(geometry, closest_on_quadric);
        rtcSetGeometryOccludedFunction(geometry, occluded_by_quadric);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene_.get(), geometry, kQuadrics);
        rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(scene_.get());
    throw_on_error(device_.get(), "build the BVH");
}

Accelerator::~Accelerator() = default;

std::optional<RayHit> Accelerator::closest(const Ray& ray) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query{};
    query.ray = make_ray(ray, std::numeric_limits<float>::infinity());
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_.get(), &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return RayHit{.distance = query.ray.tfar,
                  .barycentric = {query.hit.u, query.hit.v},
                  .primitive = query.hit.primID,
                  .is_quadric = query.hit.geomID == kQuadrics};
}

bool Accelerator::occluded(const Ray& segment) const { return occluded(segment, kSegmentEnd); }

bool Accelerator::occluded_to_infinity(const Ray& ray) const {
    return occluded(ray, std::numeric_limits<float>::infinity());
}

bool Accelerator::occluded(const Ray& ray, float far) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay query = make_ray(ray, far);
    rtcOccluded1(scene_.get(), &context, &query);
    return query.tfar < 0;
}

std::string embree_isa() {
    // Embree has no query for what it selected; its own order of preference is repeated here.
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512vl")) {
        return "AVX512";
    }
    if (__builtin_cpu_supports("avx2")) return "AVX2";
    if (__builtin_cpu_supports("avx")) return "AVX";
    return __builtin_cpu_supports("sse4.2") ? "SSE4.2" : "SSE2";
}

}  // namespace misbench
