// A method: one way to estimate the image. One instance serves one run and owns all it learns.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/base/parameters.h"
#include "renderer/image/image.h"

namespace misbench {

class Scene;
class PassContext;
class SampleObserver;
class ThreadPool;
struct SceneFeatures;

struct FrameInfo {
    int width = 0;
    int height = 0;
};

// What is left out of the image of the passes rendered so far, this one included.
struct Forgotten {
    bool all = false;
    std::vector<std::uint8_t> pixels = {};  // row by row, not 0: all of this pixel; empty: none
};

class Method {
 public:
    virtual ~Method() = default;
    // Called once, before the first pass. The scene outlives the method.
    virtual void start(const Scene& scene, FrameInfo frame) = 0;
    // One pass over the whole image: one sample a pixel, parallel inside by means of the context.
    virtual void pass(PassContext& context) = 0;
    // Serial, after a completed pass: filter, train, decide. The pass number never goes back, also
    // when the frame is dropped.
    virtual Forgotten finish_pass(ThreadPool& /*threads*/) { return {}; }
    // Passes that only train, before the image is begun and outside of the budget.
    virtual std::int64_t n_precomputed_passes() const { return 0; }
    // Whether the coming pass trains: its cost is recorded apart.
    virtual bool is_training() const { return false; }
    // Whether a pass depends on earlier ones.
    virtual bool learns() const { return false; }
    // Before start(): every sample is shown to the observer, which outlives the method. False: the
    // method cannot show its samples.
    virtual bool attach(SampleObserver& observer);
    // What the method decided or counted, for the record. Adds keys to a JSON object.
    virtual void describe(nlohmann::json& json) const;
    // What it learned, as images.
    virtual std::vector<NamedImage> maps() const { return {}; }
};

struct ParameterInfo {
    std::string name;
    ParameterValue default_value;
    std::string help;
};

// A row of the catalogue.
struct MethodInfo {
    std::string_view name;
    std::string_view summary;
    int version;           // part of a run's identity; bump it when the estimator's samples change
    bool may_be_negative;  // samples below zero are part of the estimator
    // What light of such a scene the method misses, as one sentence without its full stop; "" where
    // it estimates all light (up to the path length that its parameters allow).
    std::string (*limits)(const SceneFeatures& scene);
    std::vector<ParameterInfo> (*parameters)();
    // Defaults filled in, types and values checked. Throws ParameterError with what is known.
    ParameterMap (*effective)(const ParameterMap& given);
    std::unique_ptr<Method> (*make)(const ParameterMap& given);
};

}  // namespace misbench
