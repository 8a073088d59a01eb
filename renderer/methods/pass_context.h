// What a method sees of the render loop during one pass: pixels to estimate, random numbers that
// belong to them, rays. No clock.
#pragma once

#include <algorithm>
#include <cstddef>
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
    bool visible(const SurfacePoint& from, const SurfacePoint& to) {
        ++n_rays_;
        return scene_.visible(from, to);
    }
    bool visible(const SurfacePoint& from, Vec3 to) {
        ++n_rays_;
        return scene_.visible(from, to);
    }

 private:
    const Scene& scene_;
    std::int64_t n_rays_ = 0;
};

struct Splat {
    std::uint32_t pixel = 0;
    Rgb value;
};

// The image of one pass, and what happened in it. Memory is kept from pass to pass.
struct PassFilm {
    std::vector<Rgb> pixels;
    std::vector<std::vector<Splat>> splats;  // by chunk; those behind the last chunk are left over
    std::vector<double> splat_sums;          // scratch
    std::int64_t n_rays = 0;
    std::int64_t n_nonfinite = 0;
    std::int64_t n_negative = 0;
    std::optional<SamplePlace> first_bad;

    void clear(std::size_t n_pixels);
};

// One estimate of a pixel's value.
struct CameraSample {
    int x = 0;
    int y = 0;
    std::uint32_t pixel = 0;  // row by row
    Ray ray;                  // through a uniform point of the pixel and of the lens
};

class PassContext {
    struct ChunkResult {
        std::int64_t n_rays = 0;
        std::int64_t n_nonfinite = 0;
        std::int64_t n_negative = 0;
        std::optional<SamplePlace> first_bad;
    };

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
    const Camera& camera() const { return camera_; }
    FrameInfo frame() const { return frame_; }
    std::int64_t seed() const { return seed_; }
    // Keys the random numbers; those of precomputed passes count from kFirstPrecomputed, so that
    // the image's passes are the same with and without them.
    std::int64_t pass() const { return pass_; }
    bool is_precomputed() const { return pass_ >= kFirstPrecomputed; }
    static constexpr std::int64_t kFirstPrecomputed = std::int64_t{1} << 31;
    ThreadPool& threads() { return threads_; }

    // Estimates every pixel once: estimate(camera_sample, rng, tracer) -> Rgb. The chunks are tiles
    // of a fixed size, each pixel is written by its own chunk and its random numbers depend on
    // nothing else, so the result is the same for every number of threads.
    template <class Estimate>
    void for_each_pixel(const Estimate& estimate) {
        for_each_pixel([](std::size_t) { return nullptr; },
                       [&](std::nullptr_t, const CameraSample& sample, Rng& rng,
                           RayTracer& tracer) { return estimate(sample, rng, tracer); });
    }
    // The same with what a chunk keeps for its pixels: estimate(state, camera_sample, rng, tracer),
    // state = make_state(chunk).
    template <class MakeState, class Estimate>
    void for_each_pixel(const MakeState& make_state, const Estimate& estimate) {
        run_chunks(n_tiles(), [&](std::size_t chunk, ChunkResult& result) {
            auto state = make_state(chunk);
            const Tile tile = tile_at(chunk);
            RayTracer tracer(scene_);
            for (int y = tile.y0; y < tile.y1; ++y) {
                for (int x = tile.x0; x < tile.x1; ++x) {
                    CameraSample sample{.x = x,
                                        .y = y,
                                        .pixel = static_cast<std::uint32_t>(y * frame_.width + x),
                                        .ray = {}};
                    Rng rng(seed_, sample.pixel, static_cast<std::uint32_t>(pass_));
                    const float dx = rng.uniform();
                    const float dy = rng.uniform();
                    Vec2 lens;
                    if (camera_.has_lens()) {
                        lens.x = rng.uniform();
                        lens.y = rng.uniform();
                    }
                    sample.ray =
                        camera_.ray({static_cast<float>(x) + dx, static_cast<float>(y) + dy}, lens);
                    const Rgb value = estimate(state, sample, rng, tracer);
                    film_.pixels[sample.pixel] = value;
                    check(x, y, value, result);
                }
            }
            result.n_rays = tracer.n_rays();
        });
    }
    std::size_t n_tiles() const;

    // A part of n things to do, of a size that does not depend on the number of threads.
    class Chunk {
     public:
        std::size_t index = 0;
        std::int64_t begin = 0;
        std::int64_t end = 0;
        RayTracer tracer;

        // Adds to a pixel of the image, wherever it is; summed in the order of chunks.
        void splat(int x, int y, Rgb value) {
            splats_.push_back({static_cast<std::uint32_t>(y * context_.frame_.width + x), value});
            context_.check(x, y, value, result_);
        }

     private:
        friend class PassContext;
        Chunk(PassContext& context, std::vector<Splat>& splats, ChunkResult& result)
            : tracer(context.scene_), context_(context), splats_(splats), result_(result) {}
        PassContext& context_;
        std::vector<Splat>& splats_;
        ChunkResult& result_;
    };
    static std::size_t n_chunks(std::int64_t n, std::int64_t chunk_size) {
        return static_cast<std::size_t>((n + chunk_size - 1) / chunk_size);
    }
    // Calls work(chunk) for all of [0, n) cut into chunks. Splats are made in one such loop a pass.
    template <class Work>
    void for_each_chunk(std::int64_t n, std::int64_t chunk_size, const Work& work) {
        const std::size_t n_all = n_chunks(n, chunk_size);
        if (film_.splats.size() < n_all) film_.splats.resize(n_all);
        run_chunks(n_all, [&](std::size_t i, ChunkResult& result) {
            Chunk chunk(*this, film_.splats[i], result);
            chunk.index = i;
            chunk.begin = static_cast<std::int64_t>(i) * chunk_size;
            chunk.end = std::min(n, chunk.begin + chunk_size);
            work(chunk);
            result.n_rays = chunk.tracer.n_rays();
        });
    }
    // Of everything splatted so far; called once, at the end of the pass.
    void add_splats();

    // False when the pass was cut short: it is discarded.
    bool complete() const { return complete_; }

 private:
    struct Tile {
        int x0, y0, x1, y1;
    };

    void run_chunks(std::size_t n, const std::function<void(std::size_t, ChunkResult&)>& work);
    Tile tile_at(std::size_t chunk) const;
    // Counts a value that is not finite or negative.
    void check(int x, int y, Rgb value, ChunkResult& result) const;

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
