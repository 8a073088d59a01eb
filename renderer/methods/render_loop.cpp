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
#include "renderer/paths/sample.h"

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
    void forget(const Forgotten& forgotten) {
        if (forgotten.all) {
            std::fill(sums_.begin(), sums_.end(), 0.0);
            n_passes_ = 0;
            n_forgotten_.clear();
        }
        if (forgotten.pixels.empty()) return;
        n_forgotten_.resize(sums_.size() / 3);
        for (std::size_t i = 0; i < forgotten.pixels.size(); ++i) {
            if (forgotten.pixels[i] == 0) continue;
            for (std::size_t c = 0; c < 3; ++c) sums_[3 * i + c] = 0;
            n_forgotten_[i] = n_passes_;
        }
    }
    // Those in a pixel that forgot none.
    std::int64_t n_passes() const { return n_passes_; }
    // Every pixel has a sample.
    bool is_complete() const {
        return n_passes_ > 0 &&
               std::find(n_forgotten_.begin(), n_forgotten_.end(), n_passes_) == n_forgotten_.end();
    }

    Image mean(int width, int height) const {
        Image image(width, height);
        for (std::size_t i = 0; i < sums_.size(); ++i) {
            const std::int64_t n = n_passes_ - (n_forgotten_.empty() ? 0 : n_forgotten_[i / 3]);
            if (n > 0) image.rgb[i] = static_cast<float>(sums_[i] / static_cast<double>(n));
        }
        return image;
    }

 private:
    std::vector<double> sums_;
    std::int64_t n_passes_ = 0;
    std::vector<std::int64_t> n_forgotten_;  // by pixel: of the first passes; empty: none
};

// Shows samples while it is open.
class Gate final : public SampleObserver {
 public:
    explicit Gate(SampleObserver& observer) : observer_(observer) {}
    void open() { is_open_ = true; }

    bool wants_zeros() const override { return observer_.wants_zeros(); }
    bool wants_weights() const override { return observer_.wants_weights(); }
    void start_phase(std::size_t n_chunks) override {
        if (is_open_) observer_.start_phase(n_chunks);
    }
    void observe(const Sample& sample, std::size_t chunk) override {
        if (is_open_) observer_.observe(sample, chunk);
    }
    void finish_phase() override {
        if (is_open_) observer_.finish_phase();
    }

 private:
    SampleObserver& observer_;
    bool is_open_ = false;
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
    // Time that is nobody's: the render's clock stood still for it.
    void leave_out(Moment pause) { start_ = {start_.wall + pause.wall, start_.cpu + pause.cpu}; }

 private:
    Budget budget_;
    const ThreadPool& threads_;
    Moment start_;
};

void check_request(const RenderRequest& request) {
    if (request.width < 1 || request.height < 1 || request.threads < 1) {
        throw Error(Errc::InvalidArgument, "render " + std::to_string(request.width) + "x" +
                                               std::to_string(request.height) + " on " +
                                               std::to_string(request.threads) +
                                               " threads: all must be at least 1");
    }
    if (request.snapshots && (request.snapshots->first < 1 || request.snapshots->factor < 2)) {
        throw Error(Errc::InvalidArgument,
                    "render with snapshots after " + std::to_string(request.snapshots->first) +
                        " passes, then " + std::to_string(request.snapshots->factor) +
                        " times as many: known: from 1, then 2 times or more");
    }
}

// One render, from its first pass to its result.
class Render {
 public:
    Render(const Scene& scene, const MethodInfo& info, const RenderRequest& request)
        : scene_(scene),
          info_(info),
          request_(request),
          frame_{.width = request.width, .height = request.height},
          method_(info.make(request.parameters)),
          threads_(request.threads),
          film_(n_pixels()) {
        if (request.observer == nullptr) return;
        if (!method_->attach(gate_.emplace(*request.observer))) {
            throw Error(Errc::InvalidArgument,
                        "method '" + std::string(info.name) + "' does not show its samples");
        }
    }

    RenderResult run() {
        forget_peak_memory();
        const Disturbance before = read_disturbance();
        method_->start(scene_, frame_);
        precompute();
        if (request_.only_pass) {
            render_only(*request_.only_pass);
        } else {
            render_within_budget();
        }
        return result(before);
    }

 private:
    std::size_t n_pixels() const {
        return static_cast<std::size_t>(frame_.width) * static_cast<std::size_t>(frame_.height);
    }

    void precompute() {
        const Moment start = now(threads_);
        const std::int64_t n = method_->n_precomputed_passes();
        for (std::int64_t i = 0; i < n && !abandoned_; ++i) {
            render_pass(PassContext::kFirstPrecomputed + i);
        }
        const Moment used = now(threads_) - start;
        statistics_.precomputed_passes = n;
        statistics_.precomputed_wall_seconds = used.wall;
        statistics_.precomputed_cpu_seconds = used.cpu;
    }

    void render_only(std::int64_t pass) {
        for (std::int64_t i = method_->learns() ? 0 : pass; i < pass && !abandoned_; ++i) {
            render_pass(i);
        }
        if (gate_) gate_->open();
        if (!abandoned_ && render_pass(pass)) add_pass();
    }

    void render_within_budget() {
        watch_.emplace(request_.budget, threads_);
        if (gate_) gate_->open();
        Moment counted = watch_->start();
        std::int64_t n_rendered = 0;
        for (std::int64_t pass = 0; watch_->wants_pass(pass); ++pass) {
            const bool is_training = method_->is_training();
            const std::optional<Forgotten> forgotten = render_pass(pass);
            // A pass counts when it was complete, its training included, within the budget.
            if (!forgotten || stop_()) break;
            add_pass();
            film_.forget(*forgotten);
            n_rendered = pass + 1;
            const Moment end = now(threads_);
            if (is_training) {
                ++statistics_.training_passes;
                statistics_.training_wall_seconds += (end - counted).wall;
                statistics_.training_cpu_seconds += (end - counted).cpu;
            }
            counted = end;
            if (request_.snapshots && is_rung(*request_.snapshots, n_rendered)) {
                take_snapshot(n_rendered, end - watch_->start());
                counted = now(threads_);
                watch_->leave_out(counted - end);
            }
        }
        if (!snapshots_.empty() && snapshots_.back().statistics.samples == n_rendered) {
            snapshots_.pop_back();
        }
        const Moment used = counted - watch_->start();
        const Moment discarded = now(threads_) - counted;
        statistics_.wall_seconds = used.wall;
        statistics_.cpu_seconds = used.cpu;
        statistics_.discarded_wall_seconds = discarded.wall;
        statistics_.discarded_cpu_seconds = discarded.cpu;
    }

    void take_snapshot(std::int64_t samples, Moment used) {
        if (!film_.is_complete()) return;
        snapshots_.push_back(
            {.statistics = {.samples = samples,
                            .passes = film_.n_passes(),
                            .wall_seconds = used.wall,
                            .cpu_seconds = used.cpu,
                            .training_passes = statistics_.training_passes,
                            .training_wall_seconds = statistics_.training_wall_seconds,
                            .training_cpu_seconds = statistics_.training_cpu_seconds,
                            .rays = statistics_.rays},
             .image = film_.mean(frame_.width, frame_.height)});
    }

    // Empty: it was cut short.
    std::optional<Forgotten> render_pass(std::int64_t pass) {
        pass_film_.clear(n_pixels());
        PassContext context(scene_, frame_, request_.seed, pass, threads_, stop_, pass_film_);
        method_->pass(context);
        if (!context.complete()) return std::nullopt;
        return method_->finish_pass(threads_);
    }

    void add_pass() {
        film_.add(pass_film_);
        statistics_.rays += pass_film_.n_rays;
        statistics_.nonfinite_samples += pass_film_.n_nonfinite;
        statistics_.negative_samples += pass_film_.n_negative;
        if (!statistics_.first_bad_sample) statistics_.first_bad_sample = pass_film_.first_bad;
    }

    RenderResult result(const Disturbance& before) {
        RenderResult result;
        result.abandoned = abandoned_;
        if (abandoned_) return result;
        const Disturbance after = read_disturbance();
        statistics_.threads = request_.threads;
        statistics_.passes = film_.n_passes();
        statistics_.involuntary_context_switches =
            after.involuntary_context_switches - before.involuntary_context_switches;
        statistics_.steal_seconds = after.steal_seconds - before.steal_seconds;
        statistics_.peak_memory_bytes = after.peak_memory_bytes;
        nlohmann::json description = nlohmann::json::object();
        method_->describe(description);
        result.image = film_.mean(frame_.width, frame_.height);
        result.statistics = statistics_;
        result.valid = film_.is_complete() && statistics_.nonfinite_samples == 0 &&
                       (statistics_.negative_samples == 0 || info_.may_be_negative);
        result.description = description.dump();
        result.maps = method_->maps();
        result.snapshots = std::move(snapshots_);
        return result;
    }

    const Scene& scene_;
    const MethodInfo& info_;
    const RenderRequest& request_;
    FrameInfo frame_;
    std::unique_ptr<Method> method_;
    std::optional<Gate> gate_;
    ThreadPool threads_;
    std::optional<BudgetWatch> watch_;     // from when the budget is spent
    std::atomic<bool> abandoned_ = false;  // asked by every render thread
    const std::function<bool()> stop_ = [this] {
        if (request_.abandon && request_.abandon()) abandoned_ = true;
        return abandoned_ || (watch_ && watch_->time_is_up());
    };
    Film film_;
    PassFilm pass_film_;
    RenderStatistics statistics_;
    std::vector<Snapshot> snapshots_;
};

}  // namespace

bool Method::attach(SampleObserver& /*observer*/) { return false; }
void Method::describe(nlohmann::json& /*json*/) const {}

RenderResult render(const Scene& scene, const RenderRequest& request) {
    return render(scene, find_method(request.method), request);
}

RenderResult render(const Scene& scene, const MethodInfo& info, const RenderRequest& request) {
    check_request(request);
    return Render(scene, info, request).run();
}

}  // namespace misbench
