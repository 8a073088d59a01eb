// Passes of training made of samples that nobody traced, for providers of factors that learn.
#pragma once

#include <functional>
#include <random>
#include <string>
#include <vector>

#include "renderer/base/error.h"
#include "renderer/methods/thread_pool.h"
#include "renderer/scene/scene.h"
#include "renderer/weights/parameters.h"
#include "tests/support/made_up_samples.h"
#include "tests/support/scenes.h"

namespace misbench::test {

// One sample of a pass. The weights are those of all techniques, by index; empty: it had no
// alternatives.
struct TrainingSample {
    Pixel pixel{};
    int n_edges = 2;
    Technique technique{};
    Rgb value{};
    std::vector<double> weights{};
};
using TrainingPass = std::vector<TrainingSample>;

inline Rgb gray(float value) { return {value, value, value}; }

// Weights of all techniques of such paths, all above 0, that sum to one.
inline std::vector<double> random_weights(int n_edges, std::mt19937& rng) {
    std::exponential_distribution<double> share;
    std::vector<double> weights(static_cast<std::size_t>(n_techniques(n_edges)));
    double sum = 0;
    for (double& w : weights) sum += w = share(rng);
    for (double& w : weights) w /= sum;
    return weights;
}

class Training {
 public:
    Training(std::shared_ptr<FactorProvider> provider, int width, int height)
        : provider_(std::move(provider)), width_(width), height_(height) {
        static const Scene scene(open_box(), 1);
        provider_->start(scene, {.width = width, .height = height});
    }

    // Camera paths' samples in one phase, light paths' in one before, as in a render. `change` may
    // alter what the observer is shown.
    Forgotten pass(const TrainingPass& samples, bool is_last = false,
                   const std::function<void(MadeUpSample&)>& change = {}) {
        SampleObserver& observer = *provider_->trainer();
        for (const bool light : {true, false}) {
            observer.start_phase(1);
            for (const TrainingSample& sample : samples) {
                if ((sample.technique.kind == TechniqueKind::Light) != light) continue;
                const auto s = static_cast<std::size_t>(sample.technique.index(sample.n_edges));
                MadeUpSample made(sample.pixel, sample.n_edges, sample.technique, sample.value,
                                  sample.weights.empty() ? 1 : sample.weights[s]);
                made.sample.weights = sample.weights;
                if (sample.weights.empty()) made.sample.q = {};
                if (change) change(made);
                observer.observe(made.sample, 0);
            }
            observer.finish_phase();
        }
        return provider_->finish_pass(threads_, is_last);
    }
    Forgotten passes(const std::vector<TrainingPass>& all) {
        Forgotten forgotten;
        for (std::size_t i = 0; i < all.size(); ++i) {
            forgotten = pass(all[i], i + 1 == all.size());
        }
        return forgotten;
    }

    // c_t by index for a path seen in that pixel.
    std::vector<double> factors(Pixel pixel, int n_edges) const {
        const MadeUpSample made(pixel, n_edges, {}, {}, 1);
        std::vector<double> factors(made.q.size(), 1);
        provider_->multiply(made.path, {}, factors);
        return factors;
    }
    double factor(Pixel pixel, int n_edges, Technique technique) const {
        return factors(pixel, n_edges)[static_cast<std::size_t>(technique.index(n_edges))];
    }
    // One a pixel.
    std::vector<double> factor_image(int n_edges, Technique technique) const {
        std::vector<double> image;
        for (int y = 0; y < height_; ++y) {
            for (int x = 0; x < width_; ++x) image.push_back(factor({x, y}, n_edges, technique));
        }
        return image;
    }
    FactorProvider& provider() { return *provider_; }

 private:
    std::shared_ptr<FactorProvider> provider_;
    int width_;
    int height_;
    ThreadPool threads_{2};
};

// The key of the error that a check throws, "" where it throws none.
template <class Parameters>
std::string refused(Parameters parameters) {
    try {
        parameters.check();
        return "";
    } catch (const ParameterError& error) {
        return error.key();
    }
}

}  // namespace misbench::test
