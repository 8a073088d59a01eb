// What a method sees of the render loop during one pass: pixels to estimate, random numbers that
// belong to them, rays. No clock.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "renderer/base/render_statistics.h"
#include "renderer/base/rng.h"
#include "renderer/methods/method.h"
#include "renderer/methods/thread_pool.h"
#include "renderer/scene/camera.h"
#include "renderer/scene/light_transport.h"
#include "renderer/scene/scene.h"

namespace misbench {

// Traces rays and counts them; one per chunk of work.
class RayTracer {
 public:
    explicit RayTracer(const Scene& scene) : scene_(scene) {}

    const Scene& scene() const { return scene_; }
    std::int64_t n_rays() const { return n_rays_; }

    std::optional<SurfacePoint> closest(const Ray& ray) {
        ++n_rays_;
        return scene_.closest(ray);
    }
    // Whether light comes from there: no surface is in between.
    template <bool kPlain>
    bool visible(const SurfacePoint& from, const LightEnd& light) {
        ++n_rays_;
        return kPlain ? scene_.visible(from, light.point) : misbench::visible(scene_, from, light);
    }

 private:
    const Scene& scene_;
    std::int64_t n_rays_ = 0;
};

// The image of one pass, and what happened in it.
struct PassFilm {
    std::vector<Rgb> pixels;
    std::int64_t n_rays = 0;
    std::int64_t n_nonfinite = 0;
    std::int64_t n_negative = 0;
    std::optional<SamplePlace> first_bad;
};

class PassContext {
 public:
    PassContext(const Scene& scene, FrameInfo frame, std::int64_t seed, std::int64_t pass,
                ThreadPool& threads, const std::function<bool()>& stop, PassFilm& film)
        : scene_(scene),
          camera_(scene.camera(), frame.width, frame.height),
          frame_(frame),
          seed_(seed),
          pass_(pass),
          threads_(threads),
          stop_(stop),
          film_(film) {}

    const Scene& scene() const { return scene_; }

    // Estimates every pixel once: estimate(camera_ray, rng, tracer) -> Rgb for a ray through a
    // uniform point of the pixel and of the lens. The chunks are tiles of a fixed size, each pixel
    // is written by its own chunk and its random numbers depend on nothing else, so the result is
    // the same for every number of threads.
    template <class Estimate>
    void for_each_pixel(const Estimate& estimate) {
        run_tiles([&](const Tile& tile, TileResult& result) {
            RayTracer tracer(scene_);
            for (int y = tile.y0; y < tile.y1; ++y) {
                for (int x = tile.x0; x < tile.x1; ++x) {
                    Rng rng(seed_, static_cast<std::uint32_t>(y * frame_.width + x),
                            static_cast<std::uint32_t>(pass_));
                    const float dx = rng.uniform();
                    const float dy = rng.uniform();
                    Vec2 lens;
                    if (camera_.has_lens()) {
                        lens.x = rng.uniform();
                        lens.y = rng.uniform();
                    }
                    const Ray ray =
                        camera_.ray({static_cast<float>(x) + dx, static_cast<float>(y) + dy}, lens);
                    put(x, y, estimate(ray, rng, tracer), result);
                }
            }
            result.n_rays = tracer.n_rays();
        });
    }

    // False when the pass was cut short: it is discarded.
    bool complete() const { return complete_; }

 private:
    struct Tile {
        int x0, y0, x1, y1;
    };
    struct TileResult {
        std::int64_t n_rays = 0;
        std::int64_t n_nonfinite = 0;
        std::int64_t n_negative = 0;
        std::optional<SamplePlace> first_bad;
    };

    void run_tiles(const std::function<void(const Tile&, TileResult&)>& work);
    void put(int x, int y, Rgb value, TileResult& result);

    const Scene& scene_;
    Camera camera_;
    FrameInfo frame_;
    std::int64_t seed_;
    std::int64_t pass_;
    ThreadPool& threads_;
    const std::function<bool()>& stop_;
    PassFilm& film_;
    bool complete_ = true;
};

}  // namespace misbench
