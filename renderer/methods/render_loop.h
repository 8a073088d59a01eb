// The render loop owns budget, clock, threads and validity; a method never reads a clock.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "renderer/base/budget.h"
#include "renderer/base/parameters.h"
#include "renderer/base/render_statistics.h"
#include "renderer/base/snapshots.h"
#include "renderer/image/image.h"

namespace misbench {

class SampleObserver;
class Scene;
struct MethodInfo;

struct RenderRequest {
    std::string method;
    ParameterMap parameters;
    int width = 0;
    int height = 0;
    Budget budget = {};
    std::int64_t seed = 0;
    int threads = 1;
    // Polled between chunks; true abandons the render. Empty: never.
    std::function<bool()> abandon = {};
    // Sees every sample; null: none does. Refused by methods that do not show their samples.
    SampleObserver* observer = nullptr;
    // The image of this pass alone, and its samples: earlier ones are rendered only where the
    // method learns from them. The budget is not read.
    std::optional<std::int64_t> only_pass = {};
    // Where the render's image is kept on its way; not with only_pass.
    std::optional<SnapshotLadder> snapshots = {};
};

struct Snapshot {
    SnapshotStatistics statistics;
    Image image;
};

struct RenderResult {
    Image image;                   // the mean over the counted passes
    RenderStatistics statistics;   // load_seconds and build_seconds are the caller's to fill
    bool valid = true;             // RenderStatistics' counts against what the method declares
    std::string description;       // what the method decided, as JSON text
    std::vector<NamedImage> maps;  // what it learned
    // By growing samples, without the image itself. None where a run of as many samples is not
    // valid because some pixel has no sample yet. Making them is in no count of seconds.
    std::vector<Snapshot> snapshots;
    bool abandoned = false;  // then nothing else is meaningful
};

// An equal-sample render gives the same bits for every number of threads. A time budget that ends
// before the first pass is complete gives a black image with 0 passes, which is not valid.
RenderResult render(const Scene& scene, const RenderRequest& request);
// The same with a method that need not be in the catalogue; request.method is not read.
RenderResult render(const Scene& scene, const MethodInfo& info, const RenderRequest& request);

}  // namespace misbench
