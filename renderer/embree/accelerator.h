// Ray tracing by Embree, the only folder that knows it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "renderer/math/vec.h"
#include "renderer/scene/quadric.h"

struct RTCDeviceTy;
struct RTCSceneTy;

namespace misbench {

struct Ray {
    Vec3 origin;
    Vec3 direction;  // need not have unit length; distances are in its units
};

struct RayHit {
    float distance = 0;           // in lengths of the ray's direction
    Vec2 barycentric;             // of a triangle's second and third corner
    std::uint32_t primitive = 0;  // index into the triangles, or into the quadrics
    bool is_quadric = false;
};

class Accelerator {
 public:
    // All must outlive the accelerator; the array of vertices must have one more element than the
    // triangles use (Embree reads 16 bytes a vertex).
    Accelerator(std::span<const Vec3> vertices,
                std::span<const std::array<std::uint32_t, 3>> triangles,
                std::span<const QuadricShape> quadrics, int build_threads);
    ~Accelerator();

    // The closest hit with distance > 0.
    std::optional<RayHit> closest(const Ray& ray) const;
    // Whether something lies on the open segment from the origin to origin + direction, up to the
    // rounding of the far end.
    bool occluded(const Ray& segment) const;
    // Whether something lies on the ray, however far.
    bool occluded_to_infinity(const Ray& ray) const;

 private:
    bool occluded(const Ray& ray, float far) const;

    struct Release {
        void operator()(RTCDeviceTy* device) const;
        void operator()(RTCSceneTy* scene) const;
    };
    std::unique_ptr<RTCDeviceTy, Release> device_;
    std::unique_ptr<RTCSceneTy, Release> scene_;
};

// The instruction set that Embree selected on this machine, for example "AVX512". Bits of images
// are comparable within one instruction set only.
std::string embree_isa();

}  // namespace misbench
