// The checks of inspect.h that trace rays: emitters that look the wrong way, a camera in a wall.
#include <algorithm>
#include <limits>

#include "renderer/base/check.h"
#include "renderer/base/rng.h"
#include "renderer/scene/inspect.h"
#include "renderer/scene/light_transport.h"

namespace misbench {
namespace {

using Kind = SceneWarning::Kind;

constexpr std::uint32_t kRays = 512;  // per side of an emitter, and from the camera
constexpr float kMaxNear = 0.05F;     // D over the scene's radius, at most
constexpr double kMostly = 0.9;
constexpr double kSome = 0.1;
constexpr float kTooClose = 1e-4F;  // of the scene's radius

struct Hit {
    std::size_t object = 0;
    float distance = 0;
    SurfacePoint point{};
};

// Rays that say which object they meet. Directions are of unit length.
class Probe {
 public:
    Probe(const Scene& scene, const std::vector<SceneObject>& objects)
        : scene_(scene), objects_(objects) {}

    std::optional<Hit> trace(Vec3 origin, Vec3 direction) const {
        const auto hit = scene_.accelerator().closest({origin, direction});
        if (!hit) return std::nullopt;
        SurfacePoint point =
            hit->is_quadric
                ? scene_.point_on_quadric(hit->primitive, scene_.quadrics()[hit->primitive].at(
                                                              origin + hit->distance * direction))
                : scene_.point_on(hit->primitive, hit->barycentric);
        return Hit{object_of(hit->is_quadric, hit->primitive), hit->distance, point};
    }

    std::size_t object_of(bool is_quadric, std::size_t primitive) const {
        const auto found =
            std::partition_point(objects_.begin(), objects_.end(), [&](const SceneObject& object) {
                return object.is_quadric != is_quadric ? is_quadric : object.end <= primitive;
            });
        MISBENCH_CHECK(found != objects_.end());
        return static_cast<std::size_t>(found - objects_.begin());
    }

 private:
    const Scene& scene_;
    const std::vector<SceneObject>& objects_;
};

// The lights of one object: consecutive in Scene::lights().
struct Emitter {
    std::size_t object = 0;
    std::uint32_t first = 0;
    std::uint32_t end = 0;
};

std::vector<Emitter> emitters(const Scene& scene, const Probe& probe) {
    std::vector<Emitter> found;
    for (std::uint32_t i = 0; i < scene.lights().size(); ++i) {
        const Light& light = scene.lights()[i];
        if (!light.is_surface()) continue;
        const std::size_t object =
            probe.object_of(light.shape == Light::Shape::Quadric, light.index);
        if (found.empty() || found.back().object != object) found.push_back({object, i, i});
        found.back().end = i + 1;
    }
    return found;
}

class EmitterCheck {
 public:
    EmitterCheck(const Scene& scene, const Probe& probe, const Emitter& emitter,
                 std::span<const LightBounds> bounds)
        : scene_(scene), probe_(probe), emitter_(emitter), near_(near_distance(bounds)) {}

    bool is_flipped() const {
        std::size_t n = 0;
        std::size_t n_ending = 0;
        std::size_t n_seeing = 0;
        std::vector<double> areas;  // summed up to and with a light
        for (std::uint32_t i = emitter_.first; i < emitter_.end; ++i) {
            areas.push_back((areas.empty() ? 0 : areas.back()) + double{scene_.lights()[i].area});
        }
        for (std::uint32_t i = 0; i < kRays; ++i) {
            const double area = areas.back() * (i + 0.5) / kRays;
            const auto light =
                emitter_.first +
                static_cast<std::uint32_t>(std::lower_bound(areas.begin(), areas.end(), area) -
                                           areas.begin());
            Rng rng(0, i, 0);
            const Vec2 u{rng.uniform(), rng.uniform()};
            const Vec2 v{rng.uniform(), rng.uniform()};
            const auto start = sample_emission(scene_, light, u, {v});
            if (!start) continue;
            const SurfacePoint& point = start->point;
            const Vec3 back = start->w - 2 * dot(start->w, point.normal) * point.normal;
            ++n;
            if (ends_at_once(probe_.trace(point.leave(start->w), start->w))) ++n_ending;
            if (sees(probe_.trace(point.leave(back), back))) ++n_seeing;
        }
        return n > 0 && static_cast<double>(n_ending) >= kMostly * static_cast<double>(n) &&
               static_cast<double>(n_seeing) >= kSome * static_cast<double>(n);
    }

 private:
    float near_distance(std::span<const LightBounds> bounds) const {
        constexpr float kInfinity = std::numeric_limits<float>::infinity();
        Vec3 lower{kInfinity, kInfinity, kInfinity};
        Vec3 upper = -lower;
        for (std::uint32_t i = emitter_.first; i < emitter_.end; ++i) {
            lower = min(lower, bounds[i].lower);
            upper = max(upper, bounds[i].upper);
        }
        return std::min(0.5F * length(upper - lower), kMaxNear * scene_.radius());
    }
    bool ends_at_once(const std::optional<Hit>& hit) const {
        return hit && (hit->object == emitter_.object || hit->distance < near_);
    }
    bool sees(const std::optional<Hit>& hit) const {
        return hit && hit->object != emitter_.object && hit->distance > near_;
    }

    const Scene& scene_;
    const Probe& probe_;
    const Emitter& emitter_;
    float near_;
};

bool is_opaque(const SurfaceMaterial& material) {
    return (lobes(material) & kTransmissiveLobe) == 0;
}

void check_camera(const Scene& scene, const std::vector<SceneObject>& objects, const Probe& probe,
                  std::vector<SceneWarning>& warnings) {
    const Vec3 position = scene.camera().to_world.translation();
    bool is_inside = true;
    std::optional<Hit> nearest;
    for (std::uint32_t i = 0; i < kRays; ++i) {
        Rng rng(0, i, 0);
        const float u = rng.uniform();
        const Vec3 w = warp_sphere({u, rng.uniform()});
        const std::optional<Hit> hit = probe.trace(position, w);
        is_inside = is_inside && hit && objects[hit->object].is_closed &&
                    is_opaque(*hit->point.material) && dot(hit->point.normal, w) > 0;
        if (hit && (!nearest || hit->distance < nearest->distance)) nearest = hit;
    }
    if (!nearest) return;
    const std::string& object = objects[nearest->object].label;
    if (is_inside) {
        warnings.push_back({Kind::CameraInside, object,
                            "the camera is inside of it: all that is seen from there are the back "
                            "faces of closed opaque objects"});
    }
    if (nearest->distance < kTooClose * scene.radius()) {
        warnings.push_back({Kind::CameraTooClose, object,
                            "the camera nearly touches it: it is " +
                                std::to_string(nearest->distance / scene.radius()) +
                                " of the scene's radius away"});
    }
}

}  // namespace

std::vector<SceneWarning> check_scene(const Scene& scene, const std::vector<SceneObject>& objects) {
    const Probe probe(scene, objects);
    std::vector<SceneWarning> warnings;
    if (scene.lights().empty()) {
        warnings.push_back({Kind::NoLight, "", "the scene has no light"});
    }
    const std::vector<LightBounds> bounds = light_bounds(scene);
    for (const Emitter& emitter : emitters(scene, probe)) {
        if (!EmitterCheck(scene, probe, emitter, bounds).is_flipped()) continue;
        warnings.push_back({Kind::FlippedEmitter, objects[emitter.object].label,
                            "it seems to emit to the wrong side: its light ends on itself or right "
                            "in front of it, and its other side sees the scene"});
    }
    check_camera(scene, objects, probe, warnings);
    return warnings;
}

}  // namespace misbench
