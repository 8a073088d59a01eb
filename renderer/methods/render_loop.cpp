#include "renderer/methods/render_loop.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>

#include "renderer/base/error.h"
#include "renderer/methods/catalogue.h"
#include "renderer/methods/disturbance.h"
#include "renderer/methods/pass_context.h"

namespace misbench {
namespace {

// Wall and CPU seconds at one moment of a render.
struct Moment {
    double wall = 0;
    double cpu = 0;
};

Moment now(const ThreadPool& threads) {
    const auto steady = std::chrono::steady_clock::now().time_since_epoch();
    return {std::chrono::duration<double>(steady).count(), threads.cpu_seconds()};
}

Moment operator-(Moment a, Moment b) { return {a.wall - b.wall, a.cpu - b.cpu}; }

// Sums of the kept passes, in double, in the order of the passes.
class Film {
 public:
    explicit Film(std::size_t n_pixels) : sums_(3 * n_pixels) {}

    void add(const PassFilm& pass) {
        for (std::size_t i = 0; i < pass.pixels.size(); ++i) {
            sums_[3 * i] += double{pass.pixels[i].r};
            sums_[3 * i + 1] += double{pass.pixels[i].g};
            sums_[3 * i + 2] += double{pass.pixels[i].b};
        }
        ++n_passes_;
    }
    void drop() {
        std::fill(sums_.begin(), sums_.end(), 0.0);
        n_passes_ = 0;
    }
    std::int64_t n_passes() const { return n_passes_; }

    Image mean(int width, int height) const {
        Image image(width, height);
        if (n_passes_ == 0) return image;
        for (std::size_t i = 0; i < sums_.size(); ++i) {
            image.rgb[i] = static_cast<float>(sums_[i] / static_cast<double>(n_passes_));
        }
        return image;
    }

 private:
    std::vector<double> sums_;
    std::int64_t n_passes_ = 0;
};

// Whether a budget is used up, by passes or by the clock it names.
class BudgetWatch {
 public:
    BudgetWatch(const Budget& budget, const ThreadPool& threads)
        : budget_(budget), threads_(threads), start_(now(threads)) {}

    bool wants_pass(std::int64_t n_done) const {
        const auto* samples = std::get_if<SampleBudget>(&budget_);
        return samples == nullptr || n_done < samples->samples;
    }
    bool time_is_up() const {
        const auto* time = std::get_if<TimeBudget>(&budget_);
        if (time == nullptr) return false;
        const Moment used = now(threads_) - start_;
        return (time->clock == BudgetClock::Cpu ? used.cpu : used.wall) > time->seconds;
    }
    Moment start() const { return start_; }

 private:
    Budget budget_;
    const ThreadPool& threads_;
    Moment start_;
};

void add_events(const PassFilm& film, RenderStatistics& statistics) {
    statistics.rays += film.n_rays;
    statistics.nonfinite_samples += film.n_nonfinite;
    statistics.negative_samples += film.n_negative;
    if (!statistics.first_bad_sample) statistics.first_bad_sample = film.first_bad;
}

void check_request(const RenderRequest& request) {
    if (request.width < 1 || request.height < 1 || request.threads < 1) {
        throw Error(Errc::InvalidArgument, "render " + std::to_string(request.width) + "x" +
                                               std::to_string(request.height) + " on " +
                                               std::to_string(request.threads) +
                                               " threads: all must be at least 1");
    }
}

}  // namespace

bool Method::attach(SampleObserver& /*observer*/) { return false; }
void Method::describe(nlohmann::json& /*json*/) const {}

RenderResult render(const Scene& scene, const RenderRequest& request) {
    return render(scene, find_method(request.method), request);
}

RenderResult render(const Scene& scene, const MethodInfo& info, const RenderRequest& request) {
    check_request(request);
    const std::unique_ptr<Method> method = info.make(request.parameters);
    if (request.observer != nullptr && !method->attach(*request.observer)) {
        throw Error(Errc::InvalidArgument,
                    "method '" + std::string(info.name) + "' does not show its samples");
    }
    const FrameInfo frame{.width = request.width, .height = request.height};
    const auto n_pixels =
        static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
    Film film(n_pixels);
    RenderResult result;
    RenderStatistics& statistics = result.statistics;
    statistics.threads = request.threads;
    const Disturbance before = read_disturbance();

    ThreadPool threads(request.threads);
    const BudgetWatch watch(request.budget, threads);
    std::atomic<bool> abandoned = false;  // asked by every render thread
    const std::function<bool()> stop = [&] {
        if (request.abandon && request.abandon()) abandoned = true;
        return abandoned || watch.time_is_up();
    };
    method->start(scene, frame);
    Moment counted = watch.start();
    PassFilm pass_film;
    for (std::int64_t n_done = 0; watch.wants_pass(n_done); ++n_done) {
        const std::int64_t pass = request.first_pass + n_done;
        pass_film.clear(n_pixels);
        PassContext context(scene, frame, request.seed, pass, threads, stop, pass_film);
        method->pass(context);
        const PassOutcome outcome = context.complete() ? method->finish_pass() : PassOutcome::Keep;
        // A pass counts when it was complete, its training included, within the budget.
        if (!context.complete() || stop()) break;
        film.add(pass_film);
        add_events(pass_film, statistics);
        if (outcome == PassOutcome::Drop) film.drop();
        counted = now(threads);
    }
    if (abandoned) {
        result.abandoned = true;
        return result;
    }
    const Moment used = counted - watch.start();
    const Moment discarded = now(threads) - counted;
    const Disturbance after = read_disturbance();
    statistics.passes = film.n_passes();
    statistics.wall_seconds = used.wall;
    statistics.cpu_seconds = used.cpu;
    statistics.discarded_wall_seconds = discarded.wall;
    statistics.discarded_cpu_seconds = discarded.cpu;
    statistics.involuntary_context_switches =
        after.involuntary_context_switches - before.involuntary_context_switches;
    statistics.steal_seconds = after.steal_seconds - before.steal_seconds;
    statistics.peak_memory_bytes = after.peak_memory_bytes;
    result.image = film.mean(frame.width, frame.height);
    result.valid = statistics.passes > 0 && statistics.nonfinite_samples == 0 &&
                   (statistics.negative_samples == 0 || info.may_be_negative);
    nlohmann::json description = nlohmann::json::object();
    method->describe(description);
    result.description = description.dump();
    return result;
}

}  // namespace misbench
